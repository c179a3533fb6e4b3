-- projectile.lua: a ball thrown at 45 degrees flies a parabola, or falls shorter when drag is switched on.
local rate = param("drag", 0, "drag rate, 1/s", { min = 0 })
local g = 9.81

local scene = hooke.scene { duration = 2, fps = 60, integrator = "leapfrog" }

local p = scene:particle { position = { 0, 0, 0 }, velocity = { 10, 0, 10 }, mass = 0.45 }
scene:force("gravity", { g = { 0, 0, -g } })
if rate > 0 then scene:force("drag", { rate = rate }) end

scene:exact(function(t)
  if rate == 0 then return 10 * t, 0, 10 * t - g * t * t / 2 end
  local e = (1 - math.exp(-rate * t)) / rate
  return 10 * e, 0, (10 + g / rate) * e - g / rate * t
end)
scene:measure("range", function(s) return s:position(p)[1] end, { unit = "m" })
scene:measure("height", function(s) return s:position(p)[3] end, { unit = "m" })
scene:output("table")
return scene
