-- hooke check PLUGIN.so [name=value ...]: tests a plugin: forces against their energy, finite differences and their
-- flags; integrators by their measured order, stability limits and reversibility. One line for each property, with the
-- figure and its bound; the exit code is 1 when one fails. name=value sets numbers of the plugin.
local inspect = require("inspect")
local process = require("process")
local forces = require("common.check.forces")
local integrators = require("common.check.integrators")

local kinds = { force = forces, integrator = integrators }

local function fail(message)
  io.stderr:write("hooke: check: " .. message .. "\n")
  return 1
end

-- The report: one line per tested property.
local report = { lines = 0, failed = 0 }

-- Adds one property. `figure` and `bound` are numbers, texts or nil.
function report:add(fine, property, figure, bound)
  local function text(x) return type(x) == "number" and ("%.2g"):format(x) or x end
  self.lines = self.lines + 1
  if not fine then self.failed = self.failed + 1 end
  print(("  %-5s %-60s %s%s"):format(fine and "ok" or "WRONG", property, text(figure) or "",
    bound and (" (at most %s)"):format(text(bound)) or ""))
end

-- Adds a property that is a number, which must not be above its bound.
function report:most(property, figure, bound)
  self:add(figure <= bound, property, figure, bound) -- false for NaN
end

function report.note(_, text)
  print("  -     " .. text)
end

local path, given = nil, {}
for k = 1, #arg do
  local name, value = arg[k]:match("^([%a_][%w_]*)=(.*)$")
  if name and not tonumber(value) then return fail(("%s: '%s' is not a number"):format(name, value)) end
  if name then given[name] = tonumber(value)
  elseif path or arg[k]:sub(1, 1) == "-" then
    return fail(("'%s' is neither the plugin nor name=value"):format(arg[k]))
  else path = arg[k]:find("/", 1, true) and arg[k] or "./" .. arg[k] end
end
if not path then return fail("no plugin given: hooke check PLUGIN.so [name=value ...]") end

local plugin, why = hooke.describe(path)
if not plugin then return fail(why) end
local looks = kinds[plugin.kind]
if not looks then
  return fail(("%s is of the kind '%s': forces and integrators can be checked"):format(path, plugin.kind))
end
plugin.given = given
for name in pairs(given) do
  local known = {}
  for _, p in ipairs(plugin.params) do known[#known + 1], known[p.name] = p.name, true end
  if not known[name] then
    return fail(("%s has no parameter '%s'; did you mean '%s'?"):format(plugin.name, name,
      hooke.nearest(name, known) or ""))
  end
end

inspect.quiet()
local begun = process.clock()
print(("%s '%s': %s"):format(plugin.kind, plugin.name, plugin.summary))
looks(plugin, report)
print(("%d of %d properties hold (%.1f s)"):format(report.lines - report.failed, report.lines, process.clock() - begun))
return report.failed > 0 and 1 or 0
