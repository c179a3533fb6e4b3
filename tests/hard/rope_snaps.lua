--[[
what: a mass falls into a slack rope and bounces; a step that is too long for the taut rope makes it explode
right: closed form, a fall, half a swing on the rope, a throw back to where it came from
must: dopri5, esdirk4
also: midpoint dt=0.0166; rk4 dt=0.0166; leapfrog dt=0.0166; stoermer dt=0.0166
]]
-- The bound: a hundredth of the 0.1 m by which the rope is stretched, at every moment of the first bounce and a half.
local g, L, w = 10, 1, 100 -- m/s^2, m, 1/s
local scene = hooke.scene { duration = 1.2, fps = 60, tol = 1e-9, accuracy = 1e-3 }

scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:particle { position = { 0, 0, -0.2 }, mass = 1 }
scene:pin { 1 }
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("ropes", { edges = { { 1, 2 } }, k = w * w, rest = L })

-- Below the end of the rope: z = -L - s - A sin(w t - a), about rest s = g/w^2 lower, from z = -L at the speed v.
local v = math.sqrt(2 * g * 0.8)
local fall, s = v / g, g / w ^ 2
local A, a = math.sqrt((v / w) ^ 2 + s ^ 2), math.atan(s * w / v)
local taut = (math.pi + 2 * a) / w
scene:exact(function(t)
  t = t % (2 * fall + taut)
  if t > fall and t < fall + taut then return 0, 0, 0, 0, 0, -L - s - A * math.sin(w * (t - fall) - a) end
  local from_top = t <= fall and t or 2 * fall + taut - t
  return 0, 0, 0, 0, 0, -0.2 - g / 2 * from_top ^ 2
end)
return scene
