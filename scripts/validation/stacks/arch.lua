-- A semicircular arch of ten stones, whose joints hold any pressure but no pull and do not slide (Heyman), stands if a line of
-- thrust fits into it, and else falls by hinges at the springings, the haunches and the crown. Joints are where these open, so that
-- it takes a thickness of 0.10746 of the mean radius, where an arch of thin stones takes 0.10748. A stone is two plates, its
-- joints, and a block that has all of the mass, in its middle.
local validation = require("validation")

local n, R, depth, plate, g, thickness = 10, 1, 0.3, 0.01, 9.81, 1e-3
local alpha = math.pi / (2 * n) -- half of the angle of a stone

-- m: how far the crown sinks.
local function sinks(h, duration, t)
  local scene = hooke.scene { duration = duration, fps = 25, dt = h, integrator = "leapfrog" }
  local a, b = R - t / 2, R + t / 2
  local middle = 2 * math.sin(alpha) / (3 * alpha) * (b ^ 3 - a ^ 3) / (b ^ 2 - a ^ 2)
  local arch = {}
  for k = 1, n do
    local at, parts = alpha * (2 * k - 1 - n), {} -- from the vertical
    for _, side in ipairs { -1, 1 } do
      local joint = at + side * alpha
      local inwards = -side * (thickness + plate) / 2
      parts[#parts + 1] = { shape = "box", size = { plate, depth, t }, density = 1e-3, orientation = { 0, joint, 0 },
        position = { R * math.sin(joint) + inwards * math.cos(joint), 0, R * math.cos(joint) - inwards * math.sin(joint) } }
    end
    parts[3] = { shape = "box", size = { R * alpha, depth / 2, t / 2 }, density = 1e4, orientation = { 0, at, 0 },
      position = { middle * math.sin(at), 0, middle * math.cos(at) } }
    arch[k] = scene:rigid { parts = parts }
    arch[k]:surface()
  end
  scene:body { shape = "box", size = { 4, 2, 0.2 }, position = { 0, 0, -0.1 } }
  scene:force("gravity", { g = { 0, 0, -g } })
  scene:corrector("contact", { thickness = thickness, friction = 2 })
  return middle * math.cos(alpha) - arch[n / 2]:position(scene:run():state())[3]
end

local source = "t/R = 0.1075 (Milankovitch 1907, Z. Math. Phys. 55, 1; Heyman 1969, Int. J. Mech. Sci. 11, 363)"

return validation.problem {
  title = "A semicircular arch of stones stands with 1.01 and falls with 0.99 of the least thickness",
  quantities = {
    { name = "sinks with 1.01 of it", unit = "m", reference = 0, scale = 1, source = source, tolerance = 1e-8 },
    { name = "falls with 0.99 of it", reference = 1, source = source },
  },
  time = { 8e-3, 4e-3, 2e-3 },
  tolerance = 1e-7,
  noise = 1e-7,
  why = "what a solution leaves; a fall is 1 where the crown is lower by 1e-4 m",
  quick = { time = { 2e-2, 1e-2, 8e-3 } },
  solve = function(at)
    local duration = at.quick and 0.08 or 0.4
    local s, f = sinks(at.h, duration, 1.01 * 0.1075 * R), sinks(at.h, duration, 0.99 * 0.1075 * R)
    return { s, f > 1e-4 and 1 or 0 }
  end,
}
