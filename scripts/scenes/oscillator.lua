-- oscillator.lua: a particle on a spring of frequency 1 rad/s moves on a circle, or drifts and draws a sine, in long
-- steps: n steps per turn, and a frame after each. The errors of a method are visible in the path.
local path = param("path", "circle", "circle or sine")
local n = param("n", 16, "steps in a turn of 2 pi s", { min = 3 })
local turns = param("turns", 2, "turns to follow", { min = 0.01 })
assert(path == "circle" or path == "sine", "path is circle or sine")

local dt = 2 * math.pi / n
local scene = hooke.scene { duration = 2 * math.pi * turns, fps = 1 / dt, integrator = "leapfrog", dt = dt }

local p
if path == "circle" then
  p = scene:particle { position = { 1, 0, 0 }, velocity = { 0, 1, 0 }, mass = 1 }
  scene:force("central", { strength = 1, power = 1 })
  scene:exact(function(t) return math.cos(t), math.sin(t), 0 end)
else
  p = scene:particle { position = { 0, 0, 0 }, velocity = { 1, 1, 0 }, mass = 1 }
  scene:force("central", { axis = { 1, 0, 0 }, strength = 1, power = 1 })
  scene:exact(function(t) return t, math.sin(t), 0 end)
end

scene:measure("y", function(s) return s:position(p)[2] end, { unit = "m" })
scene:measure("energy", function(s) return s:energy() end, { unit = "J" })
return scene
