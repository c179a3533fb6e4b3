-- hooke gallery [LIST.lua]: runs chosen scenes and puts their last pictures side by side, on a page.
-- Each is run up to a chosen moment, and the page has the commands that make them; there is one picture of all, and
-- an animated picture of one scene. The list is a table (see scripts/gallery.lua): { "SCENE", at = SECONDS, param = {
-- name = value } }, ..., and `film` with width and fps. ffmpeg cuts and arranges the pictures.
local argparse = require("argparse")
local command_line = require("common.run.command_line")
local files = require("common.run.file")
local escape = require("common.run.html").escape
local lfs = require("lfs")

local function fail(text, code)
  command_line.complain("gallery", text)
  return code or 1
end

local function parser_of()
  local p = argparse("hooke gallery", "Runs chosen scenes and puts pictures of them side by side.")
  p:argument("list", "a Lua file with the scenes and moments; default: scripts/gallery.lua"):args("?")
  p:option("--out", "folder of the pictures and the page", "out/gallery")
  p:option("--only", "this scene alone")
  return p
end

local function shell(text) return "'" .. text:gsub("'", "'\\''") .. "'" end

local function here(path) return lfs.attributes(path, "mode") == "file" end

-- The scenes lie beside the list or in scenes/ there.
local function path_of(name, folder)
  for _, path in ipairs { name, ("%s/%s.lua"):format(folder, name), ("%s/scenes/%s.lua"):format(folder, name) } do
    if here(path) then return path end
  end
end

-- The pictures of a run, in their order.
local function pictures_of(folder)
  local list = {}
  if lfs.attributes(folder, "mode") ~= "directory" then return list end
  for name in lfs.dir(folder) do
    if name:match("^%d+%.png$") then list[#list + 1] = name end
  end
  table.sort(list)
  return list
end

-- The name of an item's folder below --out: that of its scene's file.
local function folder_of(item) return (item[1]:match("[^/]*$"):gsub("%.lua$", "")) end

-- The words of `hooke run`, with whose confinement the scene runs.
local function command_of(item, path, out, draft)
  local words = { shell(lfs.symlinkattributes("/proc/self/exe", "target")), "run", shell(path:gsub("^%-", "./-")) }
  for name, value in pairs(item.param or {}) do words[#words + 1] = shell(("%s=%s"):format(name, value)) end
  words[#words + 1] = ("--quiet --until %.17g --out %s"):format(item.at, shell(out))
  if draft then words[#words + 1] = "--draft" end
  return table.concat(words, " ")
end

-- Runs the scene of an item; the folder of its pictures and how many there are; or nil and why not.
local function run(item, o, folder, draft)
  local path = path_of(item[1], folder)
  if not path then return nil, ("there is no scene '%s' beside the list"):format(item[1]) end
  local out = ("%s/%s"):format(o.out, folder_of(item))
  local _, how, code = os.execute(command_of(item, path, out, draft))
  if how ~= "exit" or code ~= 0 and code ~= 5 then return nil, ("%s did not come to t = %g s"):format(path, item.at) end
  local list = pictures_of(out .. "/frames")
  if #list == 0 then return nil, ("%s made no pictures in %s/frames: does it have the output frames?"):format(path, out) end
  return out .. "/frames", list
end

-- ---- the list, which may be a stranger's ----

local function is_size(value) return math.type(value) == "integer" and value >= 1 and value <= 16384 end

-- What is wrong with an item, or nil.
local function fault_of(item)
  if type(item) ~= "table" or type(item[1]) ~= "string" then return "each of its scenes is a table that begins with a name" end
  local name = folder_of(item)
  if name == "" or name == "." or name == ".." then return ("'%s' is no scene"):format(item[1]) end
  if type(item.at) ~= "number" or not (item.at >= 0 and item.at < math.huge) then
    return ("'%s' has no moment: at = SECONDS"):format(item[1])
  end
  if item.param ~= nil and type(item.param) ~= "table" then return ("%s: param is a table"):format(item[1]) end
  for key, value in pairs(item.param or {}) do
    if not tostring(key):find("^[%a_][%w_]*$") or type(value) == "table" then
      return ("%s: param '%s' is no name = value"):format(item[1], tostring(key))
    end
  end
end

-- What is wrong with a list, or nil.
local function wrong_in(plan)
  local seen = {}
  for _, item in ipairs(plan) do
    local why = fault_of(item) or seen[folder_of(item)] and ("%s stands twice in it"):format(folder_of(item))
    if why then return why end
    seen[folder_of(item)] = true
  end
  for _, key in ipairs { "width", "height", "columns" } do
    if not is_size(plan[key]) then return ("%s has to be a whole number above 0"):format(key) end
  end
  if #plan == 0 then return "it names no scene" end
  local film = plan.film
  if film == nil then return nil end
  if fault_of(film) then return fault_of(film) end
  if not (is_size(film.width) and type(film.fps) == "number" and film.fps > 0) then
    return "film needs a width and fps, numbers"
  end
end

-- The list in the file, read as scenes are, in their sandbox and under their limits; or nil and why not.
local function read_list(path)
  local plan, why = hooke.definition(path)
  why = plan == nil and why or wrong_in(plan)
  return not why and plan or nil, why
end

-- Runs ffmpeg; nil, or what it says.
local function ffmpeg(arguments)
  local pipe = io.popen("ffmpeg -hide_banner -loglevel error -nostdin -y " .. arguments .. " 2>&1")
  local said = pipe:read("a")
  local fine, _, code = pipe:close()
  if fine then return nil end
  if code == 127 then return "there is no program ffmpeg (Debian: apt-get install ffmpeg)" end
  return "ffmpeg: " .. said:gsub("%s+$", ""):gsub("^.*\n", "")
end

-- Every picture is scaled until it covers its cell, and cut there; cells are 4 pixels apart.
local function compose(list, plan, path)
  local inputs, chain, places = {}, {}, {}
  local w, h, columns = plan.width, plan.height, math.min(plan.columns, #list)
  for k, picture in ipairs(list) do
    inputs[k] = "-i " .. shell(picture)
    chain[k] = ("[%d:v]scale=%d:%d:force_original_aspect_ratio=increase:flags=area,crop=%d:%d[c%d]"):format(k - 1, w, h,
      w, h, k)
    places[k] = ("%d_%d"):format((k - 1) % columns * (w + 4), (k - 1) // columns * (h + 4))
  end
  local cells = {}
  for k in ipairs(list) do cells[k] = ("[c%d]"):format(k) end
  local last = #list == 1 and "[c1]null" or ("%sxstack=inputs=%d:layout=%s:fill=white"):format(table.concat(cells), #list,
    table.concat(places, "|"))
  return ffmpeg(("%s -filter_complex %s -frames:v 1 %s"):format(table.concat(inputs, " "),
    shell(table.concat(chain, ";") .. ";" .. last), shell(path)))
end

-- An animated picture of 256 colours, which are those of the whole motion.
local function animate(folder, film, fps, path)
  local filter = ("fps=%g,scale=%d:-2:flags=area,split[a][b];[a]palettegen=max_colors=256:stats_mode=diff[p];"
    .. "[b][p]paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle"):format(film.fps, film.width)
  return ffmpeg(("-framerate %g -i %s -filter_complex %s -loop 0 %s"):format(fps, shell(folder .. "/%06d.png"),
    shell(filter), shell(path)))
end

local function page(shown)
  local parts = { "<!DOCTYPE html><meta charset=\"utf-8\"><title>hooke: gallery</title>\n<style>body{font-family:sans-serif;"
    .. "display:grid;grid-template-columns:repeat(auto-fill,minmax(22em,1fr));gap:1em;margin:2em}figure{margin:0}"
    .. "img{width:100%}code{font-size:85%}</style>\n" }
  for _, item in ipairs(shown) do
    parts[#parts + 1] = ("<figure><img src=\"%s\" alt=\"%s\"><figcaption><code>hooke run %s --until %g</code></figcaption>"
      .. "</figure>\n"):format(escape(item.picture), escape(item.name), escape(item.path), item.at)
  end
  return table.concat(parts)
end

local function film_of(plan, o, folder)
  local frames, list = run(plan.film, o, folder, false)
  if not frames then return list end
  return animate(frames, plan.film, (#list - 1) / plan.film.at, o.out .. "/film.gif")
end

local function chosen(plan, only)
  local list = {}
  for _, item in ipairs(plan) do
    if not only or item[1] == only then list[#list + 1] = item end
  end
  return list
end

-- Runs all; the paths of the last pictures and what the page says of them.
local function stills(plan, o, folder)
  local pictures, shown = {}, {}
  for _, item in ipairs(chosen(plan, o.only)) do
    io.stderr:write(("%s, %g s\n"):format(hooke.plain(item[1], true), item.at))
    local frames, list = run(item, o, folder, true)
    if not frames then return nil, list end
    pictures[#pictures + 1] = ("%s/%s"):format(frames, list[#list])
    shown[#shown + 1] = { name = item[1], at = item.at, path = path_of(item[1], folder),
      picture = ("%s/frames/%s"):format(folder_of(item), list[#list]) }
  end
  if #pictures == 0 then return nil, ("'%s' is not in the list"):format(o.only or "") end
  return pictures, shown
end

local o = command_line.parse("gallery", parser_of())
if not o then return 1 end
local list = o.list or hooke.library:gsub("/lib$", "") .. "/gallery.lua"
local open, why = io.open(list)
if not open then return fail(("cannot read the list of scenes %s; scripts/gallery.lua is one"):format(why), 4) end
open:close()
local plan
plan, why = read_list(list)
if not plan then
  return fail(("%s is no list of scenes: %s; scripts/gallery.lua is one, and a scene is run by hooke run or hooke view"):format(
    list, why))
end
local made, refused = files.make_folder(o.out)
if not made then return fail(refused, 4) end
local folder = list:match("^(.*)/[^/]*$") or "."
local pictures, shown = stills(plan, o, folder)
if not pictures then return fail(shown) end
why = compose(pictures, plan, o.out .. "/gallery.png")
if not why and plan.film and not o.only then why = film_of(plan, o, folder) end
if why then return fail(why, 4) end
local fine, broken = files.write(o.out .. "/index.html", page(shown))
if not fine then return fail(broken, 4) end
print(("wrote %s/gallery.png, index.html%s"):format(o.out, plan.film and not o.only and ", film.gif" or ""))
return 0
