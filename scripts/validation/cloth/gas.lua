-- Balloons of rubber, neo-Hookean and closed, by the force `pressure`. One is held at a given pressure on the rising part of
-- p(s) = 2 mu/R (1/s - 1/s^7), by implicit steps. Two hold a gas, p V^n = const. in the ambient pressure, isothermal and
-- adiabatic, that comes to rest at s = 2, where p falls: less gas than that could not stay. And one that is full but not
-- inflated breathes: rho R'' = p_in - p_out - p(s), so w^2 = (12 mu/R^2 + 3 n p_out/R)/rho for small swings.
local validation = require("validation")
local spheres = require("_spheres")

local R, Y, density, ambient = 0.1, 30, 0.3, 400
local mu = Y / 3 -- nu = 1/2
local held, grown = 1.2, 2

local function pressure(s) return spheres.pressure(mu, R, s) end

-- The overpressure at the start of a gas that balances the skin at the stretch s.
local function filling(n, s) return (ambient + pressure(s)) * s ^ (3 * n) - ambient end

-- The work of inflating to s: the skin's energy, as in the problem `balloon`.
local function skin_energy(s) return 4 * math.pi * R ^ 2 * mu / 2 * (2 * s ^ 2 + 1 / s ^ 4 - 3) end

local function balloon(n, scene, p)
  local vertices, faces = spheres.add(n, R)
  local skin = scene:mesh { vertices = vertices, faces = faces, density = density }
  scene:force("membrane", { triangles = skin:triangles(), model = "neo_hookean", stiffness = Y, nu = 0.5 })
  p.triangles, p.ambient, p.label = skin:triangles(), ambient, "gas"
  scene:force("pressure", p)
  return vertices, faces
end

local function stretch(state, vertices, faces)
  local x = {}
  for id = 1, state.n do x[id] = state:position(id) end
  return (spheres.volume(x, faces) / spheres.volume(vertices, faces)) ^ (1 / 3)
end

local function given(n)
  local scene = hooke.scene { duration = 30, fps = 2, dt = 0.02, integrator = "backward_euler" }
  local vertices, faces = balloon(n, scene, { p = pressure(held) })
  scene:force("drag", { rate = 20 })
  return stretch(validation.rest(scene, 0.5, 1e-8, 30):state(), vertices, faces)
end

-- The stretch, and the potential energy of skin and gas over that of closed forms at it.
local function filled(n, exponent)
  local scene = hooke.scene { duration = 4, fps = 10, integrator = "leapfrog" }
  local p = filling(exponent, grown)
  local vertices, faces = balloon(n, scene, { p = p, exponent = exponent })
  scene:force("drag", { rate = 60 })
  local state = validation.rest(scene, 0.1, 1e-8, 4):state()
  return stretch(state, vertices, faces), state:potential()
end

-- What the skin has taken and the gas has given at the stretch 2.
local function balance(exponent)
  local V, q = 4 / 3 * math.pi * R ^ 3, grown ^ 3
  local p = filling(exponent, grown) + ambient
  local gas = exponent == 1 and math.log(q) or (q ^ (1 - exponent) - 1) / (1 - exponent)
  return skin_energy(grown) + ambient * V * (q - 1) - p * V * gas
end

-- The angular frequency of small swings about the sphere at rest, whose corners set out at 1e-4 of their radius a second.
local function breathing(n, exponent, period)
  local scene = hooke.scene { duration = 3 * period, fps = 40 / period, integrator = "leapfrog", dt = period / 400 }
  local vertices, faces = spheres.add(n, R)
  local masses, velocities = {}, {}
  for k, v in ipairs(vertices) do masses[k], velocities[k] = 0, { v[1] * 1e-2, v[2] * 1e-2, v[3] * 1e-2 } end
  local area = 0
  for _, f in ipairs(faces) do
    local a, b, c = vertices[f[1]], vertices[f[2]], vertices[f[3]]
    local u, w = {}, {}
    for d = 1, 3 do u[d], w[d] = b[d] - a[d], c[d] - a[d] end
    local size = math.sqrt((u[2] * w[3] - u[3] * w[2]) ^ 2 + (u[3] * w[1] - u[1] * w[3]) ^ 2 + (u[1] * w[2] - u[2] * w[1]) ^ 2) / 2
    area = area + size
    for _, corner in ipairs(f) do masses[corner] = masses[corner] + density * size / 3 end
  end
  local ids = scene:particles { positions = vertices, velocities = velocities, masses = masses }:ids()
  local triangles = {}
  for k, f in ipairs(faces) do triangles[k] = { ids[f[1]], ids[f[2]], ids[f[3]] } end
  scene:force("membrane", { triangles = triangles, model = "neo_hookean", stiffness = Y, nu = 0.5 })
  scene:force("pressure", { triangles = triangles, p = 0, exponent = exponent, ambient = ambient })
  local rises = validation.crossings(1)
  local V_0 = spheres.volume(vertices, faces)
  validation.each(scene, period / 40, 120, function(s, t)
    local x, rate = {}, 0
    for id = 1, s.n do
      local v = s:velocity(id)
      x[id] = s:position(id)
      rate = rate + (x[id][1] * v[1] + x[id][2] * v[2] + x[id][3] * v[3]) / (s.n * R * R)
    end
    if t > 0 then rises(t, (spheres.volume(x, faces) / V_0) ^ (1 / 3) - 1, rate) end
  end)
  local times = rises.times
  return 2 * math.pi * (#times - 1) / (times[#times] - times[1])
end

local function frequency(exponent) return math.sqrt((12 * mu / R ^ 2 + 3 * exponent * ambient / R) / density) end

local green = "Green and Adkins 1960, 2 mu/R (1/s - 1/s^7)"
return validation.problem {
  title = "Balloons of a given pressure and of a gas",
  quantities = {
    { name = "stretch at a given pressure", reference = held, source = green },
    { name = "stretch, isothermal", reference = grown, source = green .. ", p V = const." },
    { name = "energy, isothermal", unit = "J", reference = balance(1), source = "closed form, skin and gas" },
    { name = "stretch, adiabatic", reference = grown, source = green .. ", p V^1.4 = const." },
    { name = "energy, adiabatic", unit = "J", reference = balance(1.4), source = "closed form, skin and gas" },
    { name = "breathing, adiabatic", unit = "1/s", reference = frequency(1.4),
      source = "closed form, (12 mu/R^2 + 3 n p/R)/rho" },
  },
  space = { 3, 6, 12 },
  order = { space = 2 },
  tolerance = 1e-3,
  why = "errors of order 2 leave those of order 4",
  noise = 1e-6,
  forces = { membrane = { "triangles", "stiffness", "nu", "model" } },
  quick = { space = { 2, 3, 4 }, tolerance = 3e-2 },
  solve = function(at)
    local s1, E1 = filled(at.n, 1)
    local s2, E2 = filled(at.n, 1.4)
    return { given(at.n), s1, E1, s2, E2, breathing(at.n, 1.4, 2 * math.pi / frequency(1.4)) }
  end,
}
