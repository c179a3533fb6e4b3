-- A particle slides on a floor of triangles until friction has stopped it: v^2/(2 mu g), after v/(mu g).
local validation = require("validation")
local methods = require("_methods")

local g, mu, v, radius = 9.81, 0.35, 2, 0.01

local quantities = {}
for k, name in ipairs(methods.names) do
  quantities[k] = { name = "distance, " .. name, unit = "m", reference = v * v / (2 * mu * g),
    source = "Coulomb: v^2/(2 mu g)" }
end

return validation.problem {
  title = "Stopping distance on a floor of triangles",
  quantities = quantities,
  time = { 1 / 120, 1 / 240, 1 / 480 },
  noise = 0.01,
  tolerance = 0.01,
  why = "asked for: within 1 %; what creeps, and the landing of what begins above the floor, is left",
  quick = { time = { 1 / 60, 1 / 80, 1 / 120 }, tolerance = 0.02 },
  solve = function(at)
    local found, half = {}, v / (2 * mu * g)
    for k, name in ipairs(methods.names) do
      local scene = hooke.scene { duration = 4 * half, fps = 1 / half, dt = at.h * methods.part[name],
        integrator = methods.integrator[name] }
      scene:body { shape = "box", size = { 6, 1, 0.1 }, position = { 0, 0, -0.05 } }
      local p = scene:particle { position = { 0, 0.3, radius + methods.gap[name] }, velocity = { v, 0, 0 }, mass = 1 }
      scene:force("gravity", { g = { 0, 0, -g } })
      methods.add(name, scene, { friction = mu, radius = radius })
      found[k] = scene:run():state():position(p)[1]
    end
    return found
  end,
}
