-- dam_break_sph.lua: the collapsing column of dam_break.lua by particles alone: the force `sph`, an energy of compression,
-- between walls of particles, so that nothing but the speed of sound c keeps the volume (a percent at ten times the fastest
-- flow). method = "incompressible" is that corrector (DFSPH), "grid" the corrector `liquid` on the same particles.
local a = param("a", 0.5, "width of the column, m", { min = 0.05 })
local n = param("n", 16, "particles on that width", { min = 4 })
local depth = param("depth", 0, "of the tank, which repeats, m: 6 particles at least; 0: a plane", { min = 0 })
local method = param("method", "sph", "sph, incompressible or grid")
local seconds = param("seconds", 1.2, "to simulate", { min = 0.1 })

local dx, g, density = a / n, 9.81, 1000
local c = 10 * math.sqrt(2 * g * 2 * a)
local scene = hooke.scene { duration = seconds, fps = 60, integrator = method == "sph" and "leapfrog" or "symplectic_euler",
  dt = method ~= "sph" and math.min(1 / 60, (method == "grid" and 0.3 or 0.08) * dx) or nil }

-- Particles at the middles of cubes of the lattice between two corners; returns their ids.
local function fill(group, low, high)
  local places = {}
  for i = low[1], high[1] - 1 do
    for j = low[2], high[2] - 1 do
      for k = low[3], high[3] - 1 do
        places[#places + 1] = { (i + 0.5) * dx, depth > 0 and (j + 0.5) * dx or 0, (k + 0.5) * dx }
      end
    end
  end
  return scene:particles { positions = places, mass = density * dx ^ 3, group = group }:ids()
end

local deep = depth > 0 and math.floor(depth / dx + 0.5) or 1
local water = fill("water", { 0, 0, 0 }, { n, deep, 2 * n })
scene:force("gravity", { g = { 0, 0, -g } })
if depth == 0 and method ~= "grid" then scene:pin(water, { normal = { 0, 1, 0 } }) end
if method == "grid" then
  scene:corrector("liquid", { low = { 0, 0, 0 }, high = { 4 * a, deep * dx, 3 * a }, cell = 2 * dx, density = density })
else
  local walls = {}
  local function wall(low, high)
    local ids = fill("walls", low, high)
    scene:pin(ids)
    for _, id in ipairs(ids) do walls[#walls + 1] = id end
  end
  wall({ -3, 0, -3 }, { 4 * n + 3, deep, 0 }) -- three layers, as thick as the kernel
  wall({ -3, 0, 0 }, { 0, deep, 3 * n })
  wall({ 4 * n, 0, 0 }, { 4 * n + 3, deep, 3 * n })
  if depth > 0 then scene:periodic { high = { 1, deep * dx, 1 }, axes = "y" } end
  local common = { spacing = dx, density = density, dimensions = depth > 0 and 3 or 2, wall_volume = dx ^ 3, walls = walls }
  local function with(more)
    for name, value in pairs(common) do more[name] = value end
    return more
  end
  if method == "sph" then
    scene:force("sph", with { c = c })
  else
    scene:corrector("incompressible", with {})
  end
  scene:force("viscosity", with { mu = 0.015 * density * c * dx, slip = true }) -- as Monaghan's alpha of 0.15
end

scene:measure("front", function(s) -- by the column's width, of the water on the floor
  local x = 0
  for _, id in ipairs(water) do
    local p = s:position(id)
    if p[3] < 2 * dx then x = math.max(x, p[1]) end
  end
  return (x + dx / 2) / a
end)
scene:measure("height", function(s) -- of the centre of mass, by that of water at rest in the whole tank
  local z = 0
  for _, id in ipairs(water) do z = z + s:position(id)[3] end
  return z / #water / (a / 4)
end)
if depth > 0 then
  scene:output("frames", { surface = 0.5 * dx, surface_of = "water", surface_look = "water", particles = "off", color = "none",
    surface_absorption = { 3, 0.8, 0.4 },
    from = { 5 * a, -6 * a, 3 * a }, look_at = { 1.8 * a, 0.5 * depth, 0.6 * a }, ground_height = 0 })
else
  scene:output("frames", { color = "speed", range = { 0, 4 }, from = { 2 * a, -6 * a, 1.2 * a }, radius = 0.5 * dx,
    look_at = { 2 * a, 0, 1.2 * a }, ground_height = 0 })
end
return scene
