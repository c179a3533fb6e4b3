-- t_handle.lua: a handle in the form of a T, spun about its middle axis and let go in space, turns over again and again,
-- as Dzhanibekov saw it. No force acts: spin, energy and angular momentum are the measures, and the last two do not change.
local spin = param("spin", 6, "rad/s, about the axis of the stem")
local wobble = param("wobble", 0.01, "of the spin, about the other axes")
local T = param("duration", 8, "s", { min = 0.1 })

local scene = hooke.scene { duration = T, fps = 30, dt = 1 / 240, integrator = "leapfrog" }

-- The stem lies along x, the bar along z; the moments are the least about the bar, the largest across both.
local handle = scene:rigid { density = 2700, position = { 0, 0, 0.3 }, spin = { spin, wobble * spin, wobble * spin },
  parts = {
    { shape = "capsule", radius = 0.02, length = 0.26 },
    { shape = "cylinder", radius = 0.017, length = 0.14, position = { 0.08, 0, 0 }, orientation = { 0, math.pi / 2, 0 } },
  } }

-- Along its stem.
scene:measure("spin", function(s)
  local w, R = handle:spin(s), select(2, handle:attitude(s))
  return R[1][1] * w[1] + R[2][1] * w[2] + R[3][1] * w[3]
end, { unit = "rad/s" })
scene:measure("kinetic energy", function(s) return handle:energy(s) end, { unit = "J" })
scene:measure("angular momentum", function(s)
  local L = handle:angular_momentum(s)
  return math.sqrt(L[1] ^ 2 + L[2] ^ 2 + L[3] ^ 2)
end, { unit = "kg m^2/s" })
scene:output("frames", { width = 960, height = 540, legend = false, ground_height = 0,
  from = { 0.45, -0.9, 0.55 }, look_at = { 0.02, 0, 0.3 }, fov = 18 })
return scene
