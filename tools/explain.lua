-- hooke explain SCENE.lua [name=value ...]: what will be loaded, sizes, stiffness, and the stable step per integrator.
local path, given = nil, {}
for k = 1, #arg do
  local name, value = arg[k]:match("^([%w_]+)=(.*)$")
  if name then given[name] = value
  elseif arg[k]:sub(1, 1) == "-" or path then
    io.stderr:write(("hooke: explain: '%s' is neither the scene nor name=value\n"):format(arg[k]))
    return 1
  else path = arg[k] end
end
if not path then
  io.stderr:write("hooke: explain: no scene given: hooke explain SCENE.lua [name=value ...]\n")
  return 1
end

local e, message = hooke.explain(path, given)
if not e then
  io.stderr:write("hooke: " .. message .. "\n")
  return 1
end

local function seconds(x)
  return x == math.huge and "any" or x == 0 and "none" or ("%.4g s"):format(x)
end

print(("%s: %d particles (%d pinned), %d triangles, %.4g kg; state %.3g MB"):format(e.scene, e.particles, e.pinned,
  e.triangles, e.mass, e.state_bytes / 1e6))
print(("%g s at %g frames a second with %s"):format(e.duration, e.fps, e.integrator))
print("\nloaded")
for _, p in ipairs(e.plugins) do
  print(("  %-11s %-14s %-16s %s"):format(p.kind, p.name, p.label, p.edges and ("%d edges"):format(p.edges) or ""))
end

local s = e.spectrum
print("\nlinearised at the start")
print(("  frequencies up to   %.4g 1/s (a period of %.4g s)"):format(s.w_max, s.w_max > 0 and 2 * math.pi / s.w_max or math.huge))
print(("  damping rates up to %.4g 1/s; of every mode at least %.3g + %.3g w^2"):format(s.g_max, s.alpha, s.beta))
if s.channel_rate > 0 then print(("  channels decay at   %.4g 1/s"):format(s.channel_rate)) end

print("\nlargest stable step")
table.sort(e.steps, function(a, b) return a.limit > b.limit or (a.limit == b.limit and a.name < b.name) end)
for _, step in ipairs(e.steps) do
  local note = step.growth_rate > 0
    and (" (chosen for accuracy: %.3g s; motion grows at %.3g 1/s)"):format(step.suggestion, step.growth_rate) or ""
  print(("  %-18s %-12s%s%s"):format(step.name, seconds(step.limit), note, step.name == e.integrator
    and ("  <- this scene; dt = %.4g s%s"):format(e.dt, e.dt_chosen and ", chosen" or ", given") or ""))
end
return 0
