-- wetting.lua: three plane drops without gravity, squares at first, become caps on plates that they wet, half wet and do not:
-- the surface tension of the force `surface_tension`, with the angles of contact of the plates. Measured are the angles of the caps.
local n = param("n", 8, "particles on the side of a drop", { min = 4 })
local sigma = param("tension", 0.07, "N/m", { min = 0 })
local seconds = param("seconds", 0.25, "to simulate", { min = 0.01 })

local dx, density = 0.01 / n, 1000
local c = 15 * math.sqrt(sigma / (density * dx))
local scene = hooke.scene { duration = seconds, fps = 100, integrator = "leapfrog" }

local function fill(group, low, high)
  local places = {}
  for i = low[1], high[1] - 1 do
    for k = low[2], high[2] - 1 do places[#places + 1] = { (i + 0.5) * dx, 0, (k + 0.5) * dx } end
  end
  return scene:particles { positions = places, mass = density * dx ^ 3, group = group }:ids()
end

local function common(more)
  more.spacing, more.density, more.dimensions, more.wall_volume = dx, density, 2, dx ^ 3
  return more
end

for k, angle in ipairs { 45, 90, 135 } do
  local middle = 4 * n * (k - 2)
  local drop = fill("drop", { middle - n // 2, 0 }, { middle - n // 2 + n, n })
  local plate = fill("plate", { middle - 3 * n // 2, -5 }, { middle + 3 * n // 2, 0 }) -- five layers, as thick as cohesion reaches
  scene:pin(plate)
  scene:pin(drop, { normal = { 0, 1, 0 } })
  scene:force("surface_tension", common { tension = sigma, angle = angle, particles = drop, walls = plate })
  -- Of a cap of height h and width w on the plate tan(angle/2) = 2 h/w.
  scene:measure(("angle%d"):format(angle), function(s)
    local low, high, top = math.huge, -math.huge, 0
    for _, id in ipairs(drop) do
      local p = s:position(id)
      if p[3] < 1.5 * dx then low, high = math.min(low, p[1]), math.max(high, p[1]) end
      top = math.max(top, p[3] + dx / 2)
    end
    return math.deg(2 * math.atan(2 * top, high - low + dx))
  end, { unit = "degrees" })
end
scene:force("sph", common { c = c })
scene:force("viscosity", common { mu = 0.05 * density * c * dx, slip = true })

scene:output("frames", { color = "group",
  radius = 0.5 * dx, from = { 0, -0.14, 0.02 }, look_at = { 0, 0, 0.004 }, ground_height = -5 * dx })
return scene
