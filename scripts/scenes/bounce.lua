-- bounce.lua: a ball dropped on a floor bounces lower each time, and lies still after 4.06 s. Every landing is found inside
-- the step, so that its height is right to rounding in steps of 1/60 s, whatever the method of order 2 or more.
local e = param("e", 0.8, "restitution", { min = 0, max = 0.999 })
local H, g = 1, 9.81

local scene = hooke.scene { duration = 4.5, fps = 60, integrator = "leapfrog", dt = 1 / 60 }

local ball = scene:particle { position = { 0, 0, H + 0.05 }, mass = 0.1 }
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("obstacle", { restitution = e, radius = 0.05 })

scene:exact(function(t)
  local v, fall = math.sqrt(2 * g * H), math.sqrt(2 * H / g)
  if t < fall then return 0, 0, H + 0.05 - g * t * t / 2 end
  t = t - fall
  while v > 1e-9 do
    v = e * v
    if t < 2 * v / g then return 0, 0, 0.05 + v * t - g * t * t / 2 end
    t = t - 2 * v / g
  end
  return 0, 0, 0.05
end)
scene:measure("height", function(s) return s:position(ball)[3] - 0.05 end, { unit = "m" })
scene:output("table")
return scene
