-- Taylor's and Green's vortex in a square without friction at its walls: u = sin x cos z, w = -cos x sin z (by pi) solves
-- the equations of Navier and Stokes and fades as exp(-2 nu pi^2 t) without changing its form.
local validation = require("validation")

local nu, T = 0.005, 0.5
local pi = math.pi

local function vortex(x, z) return math.sin(pi * x) * math.cos(pi * z), -math.cos(pi * x) * math.sin(pi * z) end

-- Pinned particles show the gas where they are.
local function probes(scene)
  local ids = {}
  for i = 1, 8 do
    for j = 1, 8 do ids[#ids + 1] = scene:particle { position = { (i - 0.5) / 8, 0, (j - 0.5) / 8 }, mass = 1 } end
  end
  scene:pin(ids)
  return ids
end

return validation.problem {
  title = "Decay of a vortex of Taylor and Green",
  quantities = {
    { name = "amplitude after 0.5 s", reference = math.exp(-2 * nu * pi ^ 2 * T),
      source = "Taylor and Green 1937, exp(-2 nu k^2 t)" },
    { name = "what is no vortex, RMS", unit = "m/s", reference = 0, scale = 0.5, source = "closed form: its form stays" },
  },
  space = { 16, 32, 64 },
  order = { space = 2, within = 0.3 },
  tolerance = 2e-4,
  why = "order 2 with steps of a quarter of a cell: (pi/64)^2/12 = 2e-4",
  quick = { space = { 8, 16, 24 }, tolerance = 3e-3 },
  solve = function(at)
    local steps = math.ceil(4 * T * at.n)
    local scene = hooke.scene { duration = T, fps = steps / T, dt = T / steps, integrator = "symplectic_euler" }
    local ids = probes(scene)
    scene:corrector("gas", { low = { 0, 0, 0 }, high = { 1, 0, 1 }, cell = 1 / at.n, viscosity = nu, tolerance = 1e-8,
      start_velocity = function(_, x, _, z)
        local u, w = vortex(x, z)
        return u, 0, w
      end })
    local s = scene:run():state()
    local along, all, rest = 0, 0, 0
    for _, id in ipairs(ids) do
      local x, u = s:position(id), s:field("flow", id)
      local a, b = vortex(x[1], x[3])
      along, all = along + u[1] * a + u[3] * b, all + a * a + b * b
    end
    for _, id in ipairs(ids) do
      local x, u = s:position(id), s:field("flow", id)
      local a, b = vortex(x[1], x[3])
      rest = rest + (u[1] - along / all * a) ^ 2 + (u[3] - along / all * b) ^ 2
    end
    return { along / all, math.sqrt(rest / #ids) }
  end,
}
