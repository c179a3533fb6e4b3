-- hooke new KIND NAME: writes a scene, or the shortest complete plugin of a kind and its test.
-- NAME.c is the plugin (force, constraint, corrector, source, integrator, solver, output, service) and NAME.lua its test,
-- in this folder, with a Makefile for all plugins of it; a service has its interface in NAME.h and NAME_client.c, which
-- asks it. Of a scene there is NAME.lua alone. The templates are in templates/.
local argparse = require("argparse")
local command_line = require("common.run.command_line")
local results = require("common.run.file")

local function fail(text) return command_line.complain("new", text) end

local function read(path)
  local file = io.open(path, "r")
  if not file then return nil end
  local text = file:read("a")
  file:close()
  return text
end

local kinds = { "scene", "force", "constraint", "corrector", "source", "integrator", "solver", "output", "service" }

local function parser_of()
  local p = argparse("hooke new", "Writes a scene, or the shortest complete plugin of a kind, its test and a Makefile, into this folder.")
  p:argument("kind", table.concat(kinds, ", ")):args("?")
  p:argument("name", "of the scene or the plugin: a-z, 0-9 and _"):args("?")
  return p
end

local after = {
  scene = [[
wrote FILES. Run it, look at its parameters, and at what it will load:
  hooke run NAME.lua
  hooke run NAME.lua --help
  hooke explain NAME.lua]],
  plugin = [[
wrote FILES. Build it, try it, test it:
  make
  hooke check ./NAME.so
  hooke run --trust NAME.lua
or all of it: make test-NAME]],
  -- where a Makefile of another kind is
  by_hand = [[
wrote FILES; Makefile exists already and is left as it is. Build it, try it, test it:
  cc -O3 -shared -fPIC $(hooke --cflags) NAME.c -o NAME.so
  hooke check ./NAME.so
  hooke run --trust NAME.lua]],
}

local function no_template(kind)
  local near = hooke.nearest(kind, kinds)
  return fail(("there is no template for '%s'%s"):format(kind, near and ("; did you mean '%s'?"):format(near)
    or "; the kinds are " .. table.concat(kinds, ", ")))
end

local function template(file) return read(("%s/templates/%s"):format(hooke.folder, file)) end

-- The files of that kind, { name, text } each: of a scene, its script alone.
local function files_of(kind, name)
  local files = {}
  for _, ending in ipairs { ".h", ".c", "_client.c", ".lua" } do
    local text = template(kind .. ending)
    if text then files[#files + 1] = { name .. ending, (text:gsub("NAME", name)) } end
  end
  return files
end

-- Whether the folder's Makefile is, or is going to be, the one for all plugins of a folder.
local function add_makefile(files)
  local text, there = template("Makefile"), read("Makefile")
  if not there then files[#files + 1] = { "Makefile", text } end
  return not there or there == text
end

local function listed(files)
  local names = {}
  for k, f in ipairs(files) do names[k] = f[1] end
  local last = table.remove(names)
  return #names > 0 and table.concat(names, ", ") .. " and " .. last or last
end

local o = command_line.parse("new", parser_of())
if not o then return 1 end
if not o.kind or not o.name then
  return fail(("usage: hooke new KIND NAME; the kinds are %s"):format(table.concat(kinds, ", ")))
end
if hooke.nearest(o.kind, kinds) ~= o.kind then return no_template(o.kind) end
if not o.name:match("^[a-z][a-z0-9_]*$") then
  return fail(("'%s' is no name for it: use a-z, 0-9 and _, as in my_%s"):format(o.name, o.kind))
end
local files = files_of(o.kind, o.name)
for _, f in ipairs(files) do
  if read(f[1]) then return fail(f[1] .. " exists already; it is left as it is") end
end
local how = o.kind == "scene" and "scene" or add_makefile(files) and "plugin" or "by_hand"
for _, f in ipairs(files) do
  local fine, why = results.write(f[1], f[2])
  if not fine then
    fail(why)
    return 4
  end
end
print((after[how]:gsub("FILES", listed(files)):gsub("NAME", o.name)))
return 0
