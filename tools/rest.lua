-- hooke rest SCENE.lua [name=value ...]: the equilibrium of a scene, at which it would come to rest.
-- Newton's method with a line search on the energy (native/common/equilibrium.h) from the scene's start: no time passes. The
-- verdict is by the force that is left, and by a push from which a stable equilibrium comes back.
local argparse = require("argparse")
local cjson = require("cjson")
local command_line = require("common.run.command_line")
local files = require("common.run.file")
local resting = require("resting")

local function parser()
  local p = argparse("hooke rest", "The equilibrium of a scene: where forces balance and nothing moves.")
  p:argument("scene", "the scene's script, and its parameters as name=value"):args("+")
  p:option("--tolerance", "force that may be left, relative to the largest at the start"):default("1e-9")
    :convert(command_line.positive("--tolerance"))
  p:option("--without", "label of a plugin that is left out; may be repeated"):count("*"):default({})
  p:option("--state", "write positions there, as CSV, from which scene:start { file = ... } begins")
  p:option("--out", "where the results go (out/rest/SCENE)")
  p:flag("--json", "the result as JSON on standard output")
  p:flag("--trust", "the scene may use plugins beside it")
  return p
end

local function options()
  local o = command_line.parse("rest", parser())
  if not o then return nil end
  local fine, why = command_line.take_scene("rest", o)
  if not fine then return nil, why end
  return o
end

-- The figures of the equilibrium, with the measures there; or nil and why there is none.
local function find(o)
  local scene, why = hooke.load(o.scene, o.params,
    { integrator = "backward_euler", accuracy = 0, trust = o.trust, without = o.without, output = false })
  if not scene then return nil, why end
  local fine, run = pcall(scene.run, scene, { to = 0 })
  if not fine then return nil, tostring(run) end
  local found
  found, why = resting.find(run, o.tolerance)
  if not found then return nil, why end
  found.measures, found.measure_units = run:measures(), run:summary().measure_units
  found.particles = run:state().n
  local path = o.state or o.out .. "/rest.csv"
  fine, why = resting.write(run, path)
  if not fine then return nil, why end
  found.state = path
  return found
end

-- The verdict and its words.
local function judge(found)
  if not found.balanced then
    return "not at rest", ("%.3g N are left on particle %d, where %.3g N are allowed: the scene may have no equilibrium (what is "
      .. "not held falls), or needs a start that is nearer to it"):format(found.residual, found.id, found.allowed)
  end
  local left = ("no force above %.3g N is left, %.2g of the largest at the start"):format(found.residual,
    found.first > 0 and found.residual / found.first or 0)
  if not found.asked then return "ok", left .. "; not pushed, as surfaces are in contact: whether it is stable is not known" end
  if not found.returned then
    return "not stable", ("%s, but after a push of %.2g m it goes %.2g m away"):format(left, found.pushed, found.away)
  end
  return "ok", ("%s, and it comes back after a push of %.2g m"):format(left, found.pushed)
end

local function say(o, found, verdict, reason)
  print(("%s: %d particles, at rest"):format(o.scene:match("([^/]+)%.lua$") or o.scene, found.particles))
  print(("  stages            %d of Newton's method"):format(found.stages))
  if found.lowered == found.lowered then print(("  energy            %.6g J below that of the start"):format(found.lowered)) end
  local names = {}
  for name in pairs(found.measures) do names[#names + 1] = name end
  table.sort(names)
  for _, name in ipairs(names) do
    local unit = found.measure_units[name]
    print(("  %-17s %.9g%s"):format(name, found.measures[name], unit and " " .. unit or ""))
  end
  print(("  positions         %s"):format(found.state))
  print(("  verdict           %s: %s"):format(verdict, reason))
end

local o, why = options()
if not o then return why and command_line.complain("rest", why) or 1 end
local made, refused = files.make_folder(o.out)
if not made then return command_line.complain("rest", refused) end
local found
found, why = find(o)
if not found then
  command_line.complain("rest", why)
  return 3
end
local verdict, reason = judge(found)
found.verdict, found.reason = verdict, reason
if o.json then
  if found.lowered ~= found.lowered then found.lowered = cjson.null end -- not known
  command_line.print_json(cjson.encode(found))
else say(o, found, verdict, reason) end
return verdict == "ok" and 0 or 5
