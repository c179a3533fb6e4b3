-- A balloon: a sphere of rubber is inflated to some times its radius. The pressure is p = 2 mu/R (1/s - 1/s^7) at the
-- stretch s, mu the shear modulus times the thickness at rest: it is largest at s = 7^(1/6), and falls from there on. That
-- is Laplace's law, p = 2 T/r, with the tension T = mu (1 - s^-6). The gas keeps the volume, so that the falling part is
-- stable, too. The sphere is an icosahedron, each edge divided into n.
local validation = require("validation")
local spheres = require("_spheres")

local R, Y = 0.1, 30
local mu = Y / 3 -- nu = 1/2
local stretches = { 1.2, 7 ^ (1 / 6), 2 }

local function pressure(s) return spheres.pressure(mu, R, s) end

local function energy(s) return 4 * math.pi * R ^ 2 * mu / 2 * (2 * s ^ 2 + 1 / s ^ 4 - 3) end

-- Pressure and energy of the skin of a balloon at rest, by the force of the gas: its work in growing is 3 p V = sum f.x.
local function balloon(n, s)
  local vertices, faces = spheres.add(n, R)
  local scene = hooke.scene { duration = 3, fps = 10, integrator = "leapfrog" }
  local skin = scene:mesh { vertices = vertices, faces = faces, density = 0.3 }
  scene:force("membrane", { triangles = skin:triangles(), model = "neo_hookean", stiffness = Y, nu = 0.5 })
  local stiff = 10 * mu / R
  local inflation = s ^ 3 / (1 - pressure(s) / stiff)
  scene:force("volume", { triangles = skin:triangles(), k = stiff, inflation = inflation, label = "gas" })
  scene:force("drag", { rate = 60 })
  local state, x, sum = validation.rest(scene, 0.1, 1e-8, 3):state(), {}, 0
  for id = 1, state.n do
    local f = state:force("gas", id)
    x[id] = state:position(id)
    sum = sum + f[1] * x[id][1] + f[2] * x[id][2] + f[3] * x[id][3]
  end
  local V, V_0 = spheres.volume(x, faces), spheres.volume(vertices, faces)
  local reached, p = (V / V_0) ^ (1 / 3), sum / (3 * V)
  local gas = p ^ 2 * inflation * V_0 / (2 * stiff)
  return p * pressure(s) / pressure(reached), (state:potential() - gas) * energy(s) / energy(reached), reached
end

local quantities = {}
for k, s in ipairs(stretches) do
  quantities[k] = { name = ("pressure at stretch %.4g"):format(s), unit = "Pa", reference = pressure(s),
    source = "Green and Adkins 1960, 2 mu/R (1/s - 1/s^7)" }
end
quantities[4] = { name = "energy at stretch 2", unit = "J", reference = energy(2),
  source = "closed form, 4 pi R^2 mu/2 (2 s^2 + s^-4 - 3)" }

return validation.problem {
  title = "An inflated balloon of rubber",
  quantities = quantities,
  space = { 4, 8, 16 },
  order = { space = 2 },
  tolerance = 1e-4,
  why = "errors of order 2 leave those of order 4",
  noise = 1e-7,
  forces = { membrane = { "triangles", "stiffness", "nu", "model" } },
  quick = { space = { 3, 5, 7 }, tolerance = 1e-2 },
  solve = function(at)
    local p1, p2 = balloon(at.n, stretches[1]), balloon(at.n, stretches[2])
    local p3, E = balloon(at.n, stretches[3])
    return { p1, p2, p3, E }
  end,
}
