-- The text of three.js as a plain script that defines window.THREE, with its licence, from what is installed: the older
-- files that do so themselves, CommonJS, or the ES modules that newer versions have alone (three.module.js, and
-- three.core.js where that imports it). Modules become functions: what they export goes into an object, what they import
-- is taken from one. Builds of three.js name all of it in lists, { a, b as c }; anything else is refused.
local lfs = require("lfs")

local three = {}

three.places = { "/usr/share/javascript/three/", "/usr/share/nodejs/three/build/", "/usr/local/lib/node_modules/three/build/",
  "/usr/lib/node_modules/three/build/", (hooke and hooke.folder or "tools") .. "/view/" } -- the last: of an archive that brings its own
local names = { "three.min.js", "three.js", "three.cjs", "three.module.min.js", "three.module.js" }

local licence = [[
/* three.js, https://threejs.org. The MIT License. Copyright (c) 2010-2026 three.js authors.
Permission is hereby granted, free of charge, to any person obtaining a copy of this software and associated documentation
files (the "Software"), to deal in the Software without restriction, including without limitation the rights to use, copy,
modify, merge, publish, distribute, sublicense, and/or sell copies of the Software, and to permit persons to whom the
Software is furnished to do so, subject to the following conditions: The above copyright notice and this permission notice
shall be included in all copies or substantial portions of the Software.
THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT LIMITED TO THE
WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR
COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE,
ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE. */
]]

local function read(path)
  local file = lfs.attributes(path, "mode") == "file" and io.open(path, "rb")
  if not file then return nil end
  local text = file:read("a")
  file:close()
  return text
end

-- ---- ES modules ----

-- "a, b as c" -> { { "a", "a" }, { "b", "c" } }
local function pairs_of(list)
  local all = {}
  for entry in list:gmatch("[^,]+") do
    local from, to = entry:match("^%s*([%w_$]+)%s+as%s+([%w_$]+)%s*$")
    from = from or entry:match("^%s*([%w_$]+)%s*$")
    if from then all[#all + 1] = { from, to or from } end
  end
  return all
end

local function each(list, form)
  local terms = {}
  for k, p in ipairs(pairs_of(list)) do terms[k] = form:gsub("[ab]", { a = p[1], b = p[2] }) end
  return table.concat(terms, " ")
end

-- A module as a function of `exports` and the module that it imports; and that module's file. nil: it is of another form.
local function function_of(text)
  local other
  local function from(file)
    other = other or file
    return other == file
  end
  local fine = true
  text = "\n" .. text
  text = text:gsub("([\n;])import%s*(%b{})%s*from%s*[\"']%./([%w._-]+)[\"'];?", function(before, list, file)
    fine = fine and from(file)
    return ("%sconst { %s } = imported;"):format(before, each(list:sub(2, -2), "a: b,"))
  end)
  text = text:gsub("([\n;}])export%s*(%b{})%s*from%s*[\"']%./([%w._-]+)[\"'];?", function(before, list, file)
    fine = fine and from(file)
    return before .. each(list:sub(2, -2), "exports.b = imported.a;")
  end)
  text = text:gsub("([\n;}])export%s*%*%s*from%s*[\"']%./([%w._-]+)[\"'];?", function(before, file)
    fine = fine and from(file)
    return before .. "Object.assign(exports, imported);"
  end)
  text = text:gsub("([\n;}])export%s*(%b{});?", function(before, list) return before .. each(list:sub(2, -2), "exports.b = a;") end)
  if not fine or text:find("\nimport[%s{]") or text:find("\nexport[%s{]") then return nil end
  return "((exports, imported) => { \"use strict\";" .. text .. "\n})", other
end

local function from_modules(place, text)
  local main, other = function_of(text)
  if not main then return nil end
  local core = ""
  if other then
    local imported = read(place .. other)
    local body, more = function_of(imported or "")
    if not (imported and body) or more then return nil end
    core = body .. "(imported, {});\n"
  end
  return "window.THREE = {};\n{ const imported = {};\n" .. core .. main .. "(window.THREE, imported); }\n"
end

-- ---- any of the files ----

-- The text as a script, or nil where the file is another one's wrapping, or says in the console that it is no longer kept.
local function script_of(place, name, text)
  if text:find("</script", 1, true) or text:find("are deprecated with r150", 1, true) then return nil end
  if name:find("module", 1, true) then return from_modules(place, text) end
  if not name:find("%.cjs$") then return text end
  if text:find("require%(") then return nil end
  return "window.THREE = {}; ((exports) => {" .. text .. "\n})(window.THREE);\n"
end

-- The script; nil: the reason, and what to do.
function three.script(places)
  local strange
  for _, place in ipairs(places or three.places) do
    for _, name in ipairs(names) do
      local text = read(place .. name)
      local script = text and script_of(place, name, text)
      if script then return licence .. script end
      if text then strange = place .. name end
    end
  end
  if strange then return nil, ("three.js, which draws the page's 3D view, is in %s in a form that is not known here: "
    .. "npm install -g three@0.187.0 gets one that is"):format(strange) end
  return nil, "three.js, which draws the page's 3D view, is not found: tools/install-deps run gets it (Debian: libjs-three; "
    .. "elsewhere: npm install -g three)"
end

return three
