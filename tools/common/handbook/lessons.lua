-- What a lesson shows is made when the handbook is built: "```lua NAME" is a scene, and "```file NAME" any other text, that is
-- written beside the page; "```run" are commands whose output follows them, "```diagram FILE" commands, if any, and the picture
-- that they write (a name without a folder: one that lies beside the lesson's text), "```picture WORDS" what the output `frames`
-- draws of a scene, with the text as its caption. A command that ends with another code than 0 (ok) or 5 (inaccurate) is an error
-- of the lesson.
local files = require("common.run.file")
local lfs = require("lfs")
local markdown = require("common.handbook.markdown")

local lessons = {}

local function quoted(text) return "'" .. text:gsub("'", "'\\''") .. "'" end

local function read(path)
  local file, why = io.open(path)
  if not file then error({ sentence = ("cannot read %s: %s"):format(path, why) }) end
  local text = file:read("a")
  file:close()
  return text
end
lessons.read = read

-- A scene of the installation that a command names, "scenes/NAME.lua", is put beside the lesson.
local function bring_scene(folder, command)
  local name = command:match("scenes/([%w_]+%.lua)")
  if not name then return end
  files.make_folder(folder .. "/scenes")
  assert(files.write(folder .. "/scenes/" .. name, read(hooke.library .. "/../scenes/" .. name)))
end

-- Its output.
local function run(folder, command)
  local program = lfs.symlinkattributes("/proc/self/exe", "target")
  local words = command:match("^hooke (.*)$")
  if not words then error({ sentence = ("a lesson runs hooke alone, not '%s'"):format(command) }) end
  bring_scene(folder, command)
  local quiet = words:find("^run ") and " --no-output" or ""
  local pipe = assert(io.popen(("cd %s && %s %s%s 2>&1 </dev/null"):format(quoted(folder), quoted(program), words, quiet)))
  local text = pipe:read("a")
  local _, _, code = pipe:close()
  if code and code ~= 0 and code ~= 5 then
    error({ sentence = ("'%s' of a lesson ended with code %d: %s"):format(command, code, text:gsub("%s+$", "")) })
  end
  return text
end

local function show_runs(folder)
  return function(text)
    local out = {}
    for command in text:gmatch("[^\n]+") do
      out[#out + 1] = ("<pre>%s</pre><pre class=\"output\">%s</pre>"):format(markdown.escape(command),
        markdown.escape(hooke.plain(run(folder, command))))
    end
    return table.concat(out, "\n")
  end
end

local function show_scene(folder)
  return function(text, name)
    if name ~= "" then assert(files.write(folder .. "/" .. name, text .. "\n")) end
    return ("<pre class=\"scene\">%s</pre>"):format(markdown.escape(text))
  end
end

local function figure(path, name, caption)
  local words = caption:find("%S") and "<figcaption>" .. markdown.inline((caption:gsub("\n", " "))) .. "</figcaption>" or ""
  return ("<figure><img src=\"%s\" alt=\"%s\">%s</figure>"):format(path, markdown.escape(name), words)
end

-- The commands, their output kept back, and the picture; without it where gnuplot, which draws it, is not there.
local function show_diagram(folder)
  return function(text, path)
    local shown = {}
    for command in text:gmatch("[^\n]+") do
      run(folder, command)
      shown[#shown + 1] = markdown.escape(command)
    end
    if not path:find("/") then assert(files.write(folder .. "/" .. path, read(hooke.library .. "/../handbook/" .. path))) end
    local commands = #shown > 0 and "<pre>" .. table.concat(shown, "\n") .. "</pre>\n" or ""
    if not lfs.attributes(folder .. "/" .. path) then return commands end
    return commands .. figure(path, path:match("([^/]+)%.%w+$"), "")
  end
end

local sheet = "sheet=4,pictures=false,video=false,width=640,height=400"

-- Four moments in one picture; nothing where hooke is built without pictures.
local function show_picture(folder, pictures)
  return function(caption, words)
    if not pictures then return "" end
    local name = words:match("([%w_]+)%.lua")
    bring_scene(folder, words)
    run(folder, ("hooke run %s --quiet --out pictures/%s --with output:frames:%s"):format(words, name, sheet))
    return figure(("pictures/%s/sheet.png"):format(name), name, caption)
  end
end

-- The page of a text of Markdown, in that folder. `pictures`: whether there are any.
function lessons.html(text, folder, pictures)
  return markdown.html(text, { run = show_runs(folder), lua = show_scene(folder), file = show_scene(folder),
    diagram = show_diagram(folder), picture = show_picture(folder, pictures) })
end

return lessons
