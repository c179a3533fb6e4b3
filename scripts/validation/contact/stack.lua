-- Three soft cubes lie on top of each other for a minute. Contact must not feed them: from when they have calmed down on
-- their energy stays, within a thousandth of the energy of their heights.
local validation = require("validation")
local methods = require("_methods")

local g, size, density, E, names = 9.81, 0.1, 1000, 1e5, { "impulses", "barrier" }

local quantities = {}
for k, name in ipairs(names) do
  quantities[k] = { name = "change of energy over that of the heights, " .. name, reference = 0, scale = 1,
    source = "nothing moves" }
end

-- Turned by some 17 degrees each, one above the other, at a gap at which they do not push each other yet.
local function add_cube(scene, level, gap)
  local u = { math.cos(0.3 * level), math.sin(0.3 * level), 0 }
  local v, corner = { -u[2], u[1], 0 }, -size / 2
  local cube = scene:block { nx = 2, ny = 2, nz = 2, size = { size, size, size }, density = density, u = u, v = v,
    origin = { corner * (u[1] + v[1]), corner * (u[2] + v[2]), level * size + (level + 1) * gap } }
  scene:force("neo_hookean", { tetrahedra = cube:tetrahedra(), E = E, nu = 0.3, damping = 0.01 * E,
    label = ("cube %d"):format(level) })
end

return validation.problem {
  title = "A stack at rest for a minute",
  quantities = quantities,
  time = { 1 / 20, 1 / 30, 1 / 60 },
  time_label = "frame, s; a step of the barrier",
  noise = 1e-3,
  tolerance = 1e-3,
  why = "asked for",
  quick = { time = { 1 / 10, 1 / 20, 1 / 40 } },
  solve = function(at)
    local found, calm, duration = {}, at.quick and 1 or 5, at.quick and 2 or 65
    for k, name in ipairs(names) do
      local scene = hooke.scene { duration = duration, fps = 1 / at.h, dt = name == "barrier" and at.h or nil,
        integrator = methods.integrator[name] }
      scene:body { shape = "box", size = { 1, 1, 0.1 }, position = { 0, 0, -0.05 } }
      for level = 0, 2 do add_cube(scene, level, 1.001e-3) end -- thickness, and d_hat, are 1e-3 m
      scene:force("gravity", { g = { 0, 0, -g } })
      methods.add(name, scene, { friction = 0.5, radius = 1e-3 })
      local start = scene:run { to = calm }:state():energy()
      found[k] = (scene:run():state():energy() - start) / (3 * density * size ^ 3 * g * 1.5 * size)
    end
    return found
  end,
}
