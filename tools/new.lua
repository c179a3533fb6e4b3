-- hooke new KIND NAME: writes NAME.c, the shortest complete plugin of that kind (force, constraint, corrector, source,
-- integrator, solver, output, service), and NAME.lua, its test, into this folder. The templates are in templates/.
local command_line = require("common.run.command_line")
local results = require("common.run.file")
local kind, name = arg[1], arg[2]

local function fail(text) return command_line.complain("new", text) end

local function read(path)
  local file = io.open(path, "r")
  if not file then return nil end
  local text = file:read("a")
  file:close()
  return text
end

local kinds = { "force", "constraint", "corrector", "source", "integrator", "solver", "output", "service" }

if not kind or not name or arg[3] then
  return fail(("usage: hooke new KIND NAME; the kinds are %s"):format(table.concat(kinds, ", ")))
end
local template = read(("%s/templates/%s.c"):format(hooke.folder, kind))
local scene = read(("%s/templates/%s.lua"):format(hooke.folder, kind))
if not template or not scene then
  local near = hooke.nearest(kind, kinds)
  return fail(("there is no template for '%s'%s"):format(kind, near and ("; did you mean '%s'?"):format(near)
    or "; the kinds are " .. table.concat(kinds, ", ")))
end
if not name:match("^[a-z][a-z0-9_]*$") then return fail(("'%s' is no plugin name: use a-z, 0-9 and _"):format(name)) end

local files = { { name .. ".c", template }, { name .. ".lua", scene } }
for _, f in ipairs(files) do
  if read(f[1]) then return fail(f[1] .. " exists already; it is left as it is") end
end
for _, f in ipairs(files) do
  local fine, why = results.write(f[1], (f[2]:gsub("NAME", name)))
  if not fine then
    fail(why)
    return 4
  end
end

print((([[wrote NAME.c and NAME.lua. Build it, try it, test it:
  cc -O2 -shared -fPIC $(hooke --cflags) NAME.c -o NAME.so
  hooke check ./NAME.so
  hooke run --trust NAME.lua]]):gsub("NAME", name)))
return 0
