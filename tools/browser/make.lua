-- lua5.4 make.lua ROOT BUILD PAGE: the page of hooke in a browser, as one file that opens from a disk: what `make browser`
-- has built in BUILD/browser, the view of a run that `hooke watch` serves (tools/view), the scenes, and what an installation
-- has for scripts. Packed parts are deflated and in base64 (begin.js).
local root, build, path = table.unpack(arg)
package.path = ("%s/tools/?.lua;%s"):format(root, package.path)
package.cpath = ("%s/tools/?.so;%s"):format(build, package.cpath)
hooke = { folder = root .. "/tools" } -- luacheck: globals hooke
local template = require("common.view.template")
local json_text = require("common.view.json_text")
local shared = require("common.view.shared")
local pictures = require("page")

-- The course's, their titles, and values of parameters with which they take seconds in one thread of a page.
local scenes = {
  { "string", "String" }, { "cloth", "Cloth" }, { "hair", "Hair", { strands = 6 } }, { "pleiades", "N bodies" },
  { "galaxy", "Galaxies", { N = 1000 } }, { "sand", "Sand", { n = 100 } }, { "t_handle", "Rigid body" }, { "cradle", "Newton's cradle" },
  { "stiff_string", "Stiff string" }, { "stiff_pendulum", "Stiff pendulum" }, { "curtain", "Curtain" },
  { "cloth_on_sphere", "Cloth on a ball", { N = 24 } }, { "oscillator", "Oscillator" }, { "double_pendulum", "Double pendulum" },
}

local function read(file)
  local handle = assert(io.open(file, "rb"))
  local text = handle:read("a")
  handle:close()
  return text
end

local function names(pattern)
  local pipe = assert(io.popen(("cd '%s' && ls %s"):format(root, pattern)))
  local list = {}
  for name in pipe:lines() do list[#list + 1] = name end
  pipe:close()
  return list
end

local function packed(text)
  local file = build .. "/browser/part"
  local handle = assert(io.open(file, "wb"))
  handle:write(text)
  handle:close()
  local pipe = assert(io.popen(("gzip -9 -n <'%s' | base64 -w0"):format(file)))
  local all = pipe:read("a")
  pipe:close()
  os.remove(file)
  return all
end

local function part(id, text) return ('<script type="text/plain" id="%s">%s</script>\n'):format(id, packed(text)) end

-- The view's page, with the packed colours that it has of its own.
local function view_page(nonce)
  local before, after = assert(template.parts { title = "hooke", nonce = nonce,
    modules = { "../browser/port", "stream", "hand", "drive", "live" } })
  local parts = { before }
  local out = { add = function(_, text)
    parts[#parts + 1] = ('<script type="text/plain" id="d%d">%s</script>\n'):format(#parts, text)
    return ("d%d"):format(#parts - 1)
  end }
  local data = json_text.encode { shared = shared.page_data(out) }
  return table.concat(parts) .. '<script type="application/json" id="page-data">' .. data .. "</script>\n" .. after
end

-- The comment at the head of a script, its name taken off.
local function told(script)
  local lines = {}
  for line in script:gmatch("([^\n]*)\n") do
    local text = line:match("^%-%-%s?(.*)$")
    if not text then break end
    lines[#lines + 1] = text
  end
  return (table.concat(lines, " "):gsub("^[%w_]+%.lua:%s*", ""):gsub("^%l", string.upper))
end

local function scene_list()
  local list = json_text.list()
  for k, s in ipairs(scenes) do
    local text = read(("%s/scripts/scenes/%s.lua"):format(root, s[1]))
    local with = {}
    for name, value in pairs(s[3] or {}) do with[#with + 1] = ("%s = %s"):format(name, value) end
    local few = #with > 0 and (" Here with %s."):format(table.concat(with, ", ")) or ""
    list[k] = { name = s[1], title = s[2], text = text, told = told(text) .. few, values = s[3] or {} }
  end
  return list
end

local function installation()
  local files = {}
  for _, name in ipairs(names("scripts/lib/*.lua")) do files[name] = read(root .. "/" .. name) end
  for _, name in ipairs(names("plugins/*/default plugins/synonyms")) do files["build/" .. name] = read(root .. "/" .. name) end
  return files
end

local nonce = ("%016x"):format(math.random(0)) -- of a file on a disk: the same for all who have it
local here, made = root .. "/tools/browser/", build .. "/browser/"
local thread = read(made .. "hooke.js") .. read(here .. "engine.js") .. read(here .. "worker.js")
local data = json_text.encode { scenes = scene_list(), files = installation(), kinds = pictures.shared().fields }
local scripts = { part("engine", read(made .. "hooke.wasm")), part("thread", thread), part("view", view_page(nonce)), part("data", data) }
for _, name in ipairs { "begin", "history", "editor", "page" } do
  scripts[#scripts + 1] = ('<script nonce="%s">\n%s</script>\n'):format(nonce, read(here .. name .. ".js"))
end
local version = read(root .. "/core/app/command/main.c"):match('define HK_VERSION "(.-)"')
local values = { nonce = nonce, style = read(root .. "/tools/view/page.css") .. read(here .. "page.css"), scripts = table.concat(scripts),
  about = "version " .. version }
local file = assert(io.open(path, "wb"))
file:write((read(here .. "page.html"):gsub("{{(%w+)}}", values)))
file:close()
