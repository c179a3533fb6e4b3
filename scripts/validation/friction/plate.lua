-- A plate, one triangle, falls flat through air with a drag of v^2: vt tanh(g t/vt), and ln cosh for the way.
local validation = require("validation")

local g, mass, rho, drag, side, t_end = 9.81, 0.01, 1.2, 1.2, 0.2, 1
local vt = math.sqrt(2 * mass * g / (rho * drag * side * side / 2))

local function cosh(x) return (math.exp(x) + math.exp(-x)) / 2 end
local function tanh(x) return (math.exp(x) - math.exp(-x)) / (math.exp(x) + math.exp(-x)) end

return validation.problem {
  title = "A plate falls flat through air",
  quantities = {
    { name = "speed after 1 s", unit = "m/s", reference = vt * tanh(g * t_end / vt),
      source = "closed form, vt tanh(g t/vt), vt^2 = 2 m g/(rho A c)" },
    { name = "way after 1 s", unit = "m", reference = vt * vt / g * math.log(cosh(g * t_end / vt)),
      source = "closed form, vt^2/g ln cosh(g t/vt)" },
  },
  time = { 0.04, 0.02, 0.01 },
  order = { time = 4 },
  tolerance = 1e-8,
  why = "order 4, 1e-7 at the finest step",
  forces = { wind = { "velocity", "density", "drag", "lift" } },
  quick = { time = { 0.04, 0.02, 0.01 }, tolerance = 1e-7 },
  solve = function(at)
    local scene = hooke.scene { duration = t_end, fps = 5, dt = at.h, integrator = "rk4" }
    local plate = scene:mesh { vertices = { { 0, 0, 0 }, { side, 0, 0 }, { 0, side, 0 } }, faces = { { 1, 2, 3 } },
      mass = mass }
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:force("wind", { velocity = { 0, 0, 0 }, density = rho, drag = drag, lift = 0 })
    local s, corner = scene:run():state(), plate:ids()[1]
    return { -s:velocity(corner)[3], -s:position(corner)[3] }
  end,
}
