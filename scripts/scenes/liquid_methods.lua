-- liquid_methods.lua: the same water on the same particles by a grid (`liquid`), by pressures between particles (`incompressible`) and
-- by their compression (`sph`), in four problems with known answers, for scripts/sweeps/liquids.lua: how far off is each?
local problem = param("problem", "wave", "wave: half a period; vortex: decay of Taylor and Green's; dam: its front; " ..
  "plates: start-up of Poiseuille's flow")
local method = param("method", "grid", "grid, incompressible or sph")
local n = param("n", 16, "particles on a metre, on a dam's width or between plates", { min = 6 })

local g, pi, density = 9.81, math.pi, 1000
local all = {
  wave = { width = 1, height = 0.5, room = 0.75, seconds = 0.75, speed = 3, dt = 0.005, g = g },
  vortex = { width = 1, height = 1, room = 1, seconds = 0.25, speed = 0.3, dt = 0.002, g = 0, nu = 0.05 },
  plates = { width = 3, height = 1, room = 1, seconds = 2.5, speed = 0.2, dt = 0.0125, g = 0, nu = 0.1, pull = 0.08 },
  dam = { width = 0.5, tank = 2, height = 1, room = 1.5, seconds = 0.52, speed = 6, dt = 1 / 60, g = g },
}
local at = all[problem]
local dx = (problem == "dam" and 0.5 or 1) / n
local c = 10 * at.speed
local plates = problem == "plates"
if plates and method ~= "grid" then at.width = 6 * dx end -- it repeats; the grid's water has free ends, far from its middle
local tank = at.tank or at.width
local longest = { sph = 0.5 * dx / c, incompressible = 0.08 * dx, grid = 0.3 * dx } -- s; sound, and flow of some m/s
if plates and method ~= "grid" then at.dt = math.min(at.dt, 0.15 * dx ^ 2 / at.nu) end -- of the explicit viscosity
local steps = 50 * math.ceil(at.seconds / math.min(at.dt, longest[method]) / 50)
local scene = hooke.scene { duration = at.seconds, fps = 50 / at.seconds, dt = at.seconds / steps,
  integrator = method == "sph" and "leapfrog" or "symplectic_euler" }

-- ---- water, walls of three layers, forces ----

local k = pi
local function tanh(x) return 1 - 2 / (math.exp(2 * x) + 1) end
local function sinh(x) return (math.exp(x) - math.exp(-x)) / 2 end
local function cosh(x) return (math.exp(x) + math.exp(-x)) / 2 end
local w = math.sqrt(g * k * tanh(k * at.height)) -- Airy

local function start(x, z)
  if problem == "wave" then
    local by = 0.03 * w / sinh(k * at.height)
    return { by * cosh(k * z) * math.sin(k * x), 0, -by * sinh(k * z) * math.cos(k * x) }
  elseif problem == "vortex" then
    return { 0.1 * math.sin(pi * x) * math.cos(pi * z), 0, -0.1 * math.cos(pi * x) * math.sin(pi * z) }
  end
end

local depth = method == "grid" and 2 * dx or dx -- of a plane liquid: a cell, or a spacing

local function fill(low, high, velocity)
  local ids = {}
  for i = math.floor(low[1] / dx + 0.5), math.floor(high[1] / dx + 0.5) - 1 do
    for j = math.floor(low[2] / dx + 0.5), math.floor(high[2] / dx + 0.5) - 1 do
      local x, z = (i + 0.5) * dx, (j + 0.5) * dx
      ids[#ids + 1] = scene:particle { position = { x, 0, z }, velocity = velocity and velocity(x, z), mass = density * dx ^ 2 * depth }
    end
  end
  return ids
end

local water = fill({ 0, 0 }, { at.width, at.height }, start)
if at.g > 0 then scene:force("gravity", { g = { 0, 0, -g } }) end
if at.pull then scene:force("gravity", { g = { at.pull, 0, 0 }, only = water }) end
if method == "grid" then
  local aside = plates and 0.5 or 0
  scene:corrector("liquid", { low = { -aside, 0, 0 }, high = { tank + aside, 0, at.room }, cell = 2 * dx, density = density,
    viscosity = at.nu and density * at.nu or 0, walls = at.nu and not plates and "free_slip" or nil })
else
  local thick, walls = 3 * dx, {}
  local function wall(low, high)
    for _, id in ipairs(fill(low, high)) do walls[#walls + 1] = id end
  end
  local aside = plates and 0 or thick
  wall({ -aside, -thick }, { tank + aside, 0 })
  if plates then
    scene:periodic { high = { tank, 1, 1 }, axes = "x" }
  else
    wall({ -thick, 0 }, { 0, at.room })
    wall({ tank, 0 }, { tank + thick, at.room })
  end
  if problem == "vortex" or plates then wall({ -aside, at.room }, { tank + aside, at.room + thick }) end
  scene:pin(walls)
  scene:pin(water, { normal = { 0, 1, 0 } })
  local function common(more)
    more.spacing, more.density, more.dimensions, more.wall_volume = dx, density, 2, dx ^ 3
    return more
  end
  if method == "sph" then
    scene:force("sph", common { c = c, cavitates = problem ~= "vortex" and not plates })
  else
    scene:corrector("incompressible", common {})
  end
  local nu = at.nu or (problem == "dam" and 0.02 * c * dx or 0)
  if nu > 0 then scene:force("viscosity", common { mu = density * nu, slip = not plates }) end
end

-- ---- how far off, as a part of the answer; the last value counts ----

local found, before, x0 = {}, nil, {}

local function wave_error(s)
  local y = 0
  for i, id in ipairs(water) do
    local x = s:position(id)[1]
    x0[i] = x0[i] or x
    y = y + (x - x0[i]) * math.sin(k * x0[i])
  end
  local t = s.t
  if before and before.y > 0 and y <= 0 then found[1] = t - (t - before.t) * y / (y - before.y) end
  before = { t = t, y = y }
  return found[1] and math.abs(found[1] * w / pi - 1) or 1
end

local function vortex_error(s)
  local sum, norm = 0, 0
  for _, id in ipairs(water) do
    local m, v = start(s:position(id)[1], s:position(id)[3]), s:velocity(id)
    sum, norm = sum + m[1] * v[1] + m[3] * v[3], norm + m[1] * m[1] + m[3] * m[3]
  end
  local t, amplitude = s.t, sum / norm
  if not before and t >= 0.05 then before = { t = t, y = amplitude } end
  if not before or t <= before.t then return 1 end
  return math.abs(math.log(before.y / amplitude) / (t - before.t) / (2 * pi * pi * at.nu) - 1)
end

local function dam_error(s) -- Martin and Moyce 1952, with their diaphragm's delay of 0.25: 3 widths at T = 2.51
  local x = 0
  for _, id in ipairs(water) do
    local p = s:position(id)
    if p[3] < 2 * dx then x = math.max(x, p[1] + dx / 2) end
  end
  local t = s.t
  if before and before.y < 3 * 0.5 and x >= 3 * 0.5 then found[1] = t - (t - before.t) * (x - 1.5) / (x - before.y) end
  before = { t = t, y = x }
  return found[1] and math.abs(found[1] * math.sqrt(2 * g / 0.5) / (2.51 - 0.25) - 1) or 1
end

local function plates_error(s) -- of the mean speed, in the middle gap of the grid's three
  local sum, count, series = 0, 0, 0
  for _, id in ipairs(water) do
    if method ~= "grid" or math.abs(s:position(id)[1] - tank / 2) < 0.5 then
      sum, count = sum + s:velocity(id)[1], count + 1
    end
  end
  for m = 1, 39, 2 do series = series + math.exp(-m * m * pi * pi * at.nu * s.t) / m ^ 4 end
  local mean = at.pull / (12 * at.nu) * (1 - 96 / pi ^ 4 * series)
  return s.t > 0 and math.abs(sum / count / mean - 1) or 1
end

scene:measure("error", ({ wave = wave_error, vortex = vortex_error, dam = dam_error, plates = plates_error })[problem])
return scene
