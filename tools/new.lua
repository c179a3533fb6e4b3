-- hooke new KIND NAME: writes a scene, or the shortest complete plugin of a kind and its test.
-- NAME.c is the plugin (force, constraint, corrector, source, integrator, solver, output, service) and NAME.lua its test,
-- in this folder; of a scene there is NAME.lua alone. The templates are in templates/.
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
  local p = argparse("hooke new", "Writes a scene, or the shortest complete plugin of a kind and its test, into this folder.")
  p:argument("kind", table.concat(kinds, ", ")):args("?")
  p:argument("name", "of the scene or the plugin: a-z, 0-9 and _"):args("?")
  return p
end

local after = {
  scene = [[
wrote NAME.lua. Run it, look at its parameters, and at what it will load:
  hooke run NAME.lua
  hooke run NAME.lua --help
  hooke explain NAME.lua]],
  plugin = [[
wrote NAME.c and NAME.lua. Build it, try it, test it:
  cc -O3 -shared -fPIC $(hooke --cflags) NAME.c -o NAME.so
  hooke check ./NAME.so
  hooke run --trust NAME.lua]],
}

local function no_template(kind)
  local near = hooke.nearest(kind, kinds)
  return fail(("there is no template for '%s'%s"):format(kind, near and ("; did you mean '%s'?"):format(near)
    or "; the kinds are " .. table.concat(kinds, ", ")))
end

-- The files of that kind, { name, text } each: of a scene, its script alone.
local function files_of(kind, name)
  local files = {}
  for _, ending in ipairs { "c", "lua" } do
    local text = read(("%s/templates/%s.%s"):format(hooke.folder, kind, ending))
    if text then files[#files + 1] = { ("%s.%s"):format(name, ending), text } end
  end
  return files
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
for _, f in ipairs(files) do
  local fine, why = results.write(f[1], (f[2]:gsub("NAME", o.name)))
  if not fine then
    fail(why)
    return 4
  end
end
print((after[o.kind == "scene" and "scene" or "plugin"]:gsub("NAME", o.name)))
return 0
