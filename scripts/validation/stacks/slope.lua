-- A box on another body whose surface is at 1.01 and 0.99 of the friction that holds it, tan a: it stays, or slides with g (sin
-- a - mu cos a).
local validation = require("validation")
local boxes = require("_boxes")

local g, a, t_end = 9.81, 0.4, 0.5

local function way(h, part)
  local scene, list = boxes.scene(h, t_end, part * math.tan(a), { { 0, boxes.height(1) } },
    { g * math.sin(a), 0, -g * math.cos(a) })
  return list[1]:position(scene:run():state())[1]
end

return validation.problem {
  title = "A box on a body at 1.01 and 0.99 of the critical friction",
  quantities = {
    { name = "creep in 0.5 s, mu = 1.01", unit = "m", reference = 0, scale = 1, source = "Coulomb: it sticks", tolerance = 1e-8 },
    { name = "way in 0.5 s, mu = 0.99", unit = "m", reference = 0.01 * g * math.sin(a) * t_end ^ 2 / 2,
      source = "Coulomb: g (sin a - mu cos a) t^2/2" },
  },
  time = { 4e-3, 2e-3, 1e-3 },
  tolerance = 1e-5,
  noise = 1e-5,
  why = "the force is constant, so that every step is exact but for what contact leaves",
  quick = { time = { 5e-3, 4e-3, 2e-3 } },
  solve = function(at) return { way(at.h, 1.01), way(at.h, 0.99) } end,
}
