-- circle.lua: a particle with a force to the origin proportional to its distance moves on a circle. Euler increases the
-- radius by the factor sqrt(1 + h^2 w^2) at every step, leapfrog keeps it: try --integrator euler --dt 0.001.
local speed = 5 -- m/s at 1 m from the centre, so w = 5 1/s closes the circle

local scene = hooke.scene { duration = 4, fps = 60, integrator = "leapfrog", dt = 1 / 480 }

local p = scene:particle { position = { 1, 0, 0 }, velocity = { 0, speed, 0 }, mass = 1 }
scene:force("central", { center = { 0, 0, 0 }, strength = speed ^ 2, power = 1 })

scene:exact(function(t) return math.cos(speed * t), math.sin(speed * t), 0 end)
scene:output("frames", { width = 640, height = 640, from = { 0, -1.5, 3.5 }, look_at = { 0, 0, 0 } })
scene:measure("radius", function(s)
  local x = s:position(p)
  return math.sqrt(x[1] ^ 2 + x[2] ^ 2)
end, { unit = "m" })
return scene
