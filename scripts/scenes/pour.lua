-- pour.lua: water is poured into a bowl and sloshes: grains without friction, of which the surface is seen. It mirrors the
-- sky, bends what is seen through it, and is the bluer the deeper it is.
local R = param("radius", 0.0105, "of a grain, m", { min = 0.005, max = 0.03 })
local speed = param("speed", 1.2, "in the spout, m/s", { min = 0.2, max = 5 })
local stop = param("stop", 2.2, "when it is turned off, s", { min = 0.1, max = 2.5 })
local size = param("size", 0.006, "of the bowl's triangles, m", { min = 0.003, max = 0.05 })
local inner, wall, middle, rim = 0.22, 0.012, 0.232, 0.15 -- m: of the bowl, radius, wall, height of its middle and of its rim
local spout = { -0.08, 0, 0.41 }

local scene = hooke.scene { duration = 2.5, fps = 30, dt = 1 / 7000, integrator = "leapfrog" }
scene:channel("radius", { initial = R })
scene:service("neighbours", { skin = 0.25 })
for k = 0, 6 do -- seven threads side by side: grains that do not overlap
  local out, a = k > 0 and 2.1 * R or 0, k * math.pi / 3
  scene:source("emitter", { rate = speed / (2 * R), from = k / 7 * 2 * R / speed, to = stop, shape = "point", speed = speed,
    direction = { 0, 0, -1 }, position = { spout[1] + out * math.cos(a), spout[2] + out * math.sin(a), spout[3] },
    radius = R, mass = 4000 / 3 * math.pi * R ^ 3, group = "water", label = "thread " .. k }) -- 1,000 kg/m^3
end
scene:force("gravity", { g = { 0, 0, -9.81 }, group = "water" })
scene:force("soft_spheres", { radii = "radius", stiffness = 500, restitution = 0.4, friction = 0, group = "water" })
local stiffness, damping = 1000, 1 -- N/m, s/m: Hunt and Crossley's law
scene:force("field", { f = function(_, x, y, z, vx, vy, vz) -- the bowl's inside, and the ball's that it is a part of
  local r = math.sqrt(x * x + y * y + (z - middle) ^ 2)
  if r < inner - R then return 0, 0, 0 end
  local nx, ny, nz = x / r, y / r, (z - middle) / r
  local N = stiffness * (r - inner + R) * math.max(1 + damping * (vx * nx + vy * ny + vz * nz), 0)
  return -N * nx, -N * ny, -N * nz
end, label = "inside" })

-- The bowl and the spout as they are seen: what the grains feel is the ball above, and the shape touches one pin alone.
local function shape(x, y, z)
  local across, h = math.sqrt(x * x + y * y), z - middle
  local r, edge = math.sqrt(across * across + h * h), rim - middle
  local lip = 0.75 * wall - math.sqrt((across - math.sqrt((inner + wall / 2) ^ 2 - edge * edge)) ^ 2 + (h - edge) ^ 2)
  local foot = math.min(0.07 - across, z, 0.04 - z, r - inner)
  local pipe = math.min(3.7 * R - math.sqrt((x - spout[1]) ^ 2 + (y - spout[2]) ^ 2), z - spout[3])
  return math.max(math.min(inner + wall - r, r - inner, edge - h), lip, foot, pipe)
end
local seen = scene:implicit { f = shape, box = { { -0.26, -0.26, -0.01 }, { 0.26, 0.26, 0.6 } }, size = size, close = true,
  coarse = 2, as = "surface" }
local pin = scene:particle { position = { 0, 0, 0.3 }, mass = 1 }
scene:pin(pin)
scene:force("penalty", { shape = "mesh", vertices = seen.vertices, faces = seen.faces, only = { pin }, label = "bowl" })

scene:measure("grains", function(s) return s.n - 1 end)
scene:measure("lowest", function(s)
  local z = math.huge
  for _, id in ipairs(s:ids()) do z = math.min(z, s:position(id)[3]) end
  return z
end, { unit = "m" })
scene:output("frames", { surface = R, surface_of = "water", surface_look = "water", surface_absorption = { 12, 2.5, 0.9 },
  color = "none", from = { 0.24, -1.12, 0.6 }, look_at = { -0.01, 0, 0.185 }, ground_height = 0, fov = 26 })
return scene
