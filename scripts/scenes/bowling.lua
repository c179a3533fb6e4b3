-- bowling.lua: a ball slides down a lane, rolls after 4.4 m, and knocks pins over. `fallen` counts the pins that lean by more
-- than half a radian; `slip` is the speed at which the ball rubs the lane, m/s, 0 once it rolls.
local T = param("duration", 2.4, "s", { min = 0.1 })
local v = param("speed", 6, "m/s")
local rows = param("rows", 4, "rows of pins", { min = 1, max = 6 })
local mu = param("friction", 0.2, "")

local scene = hooke.scene { duration = T, fps = 50, dt = 1 / 1000, integrator = "leapfrog" }

local g, r, start, foot = 9.81, 0.11, -5, 0.002 -- m/s^2, m; the ball touches the lane, the pins stand a thickness off it
scene:body { shape = "box", size = { 9, 1.2, 0.2 }, position = { -1.5, 0, -0.1 } }
local ball = scene:rigid { shape = "sphere", radius = r, mass = 6, position = { start, 0.02, r + 1e-4 }, velocity = { v, 0, 0 } }
ball:surface { { 0, 0, 0 } }

local pins = {}
for row = 1, rows do
  for k = 1, row do
    local pin = scene:rigid { shape = "box", size = { 0.09, 0.09, 0.38 }, mass = 1.5,
      position = { 0.26 * (row - 1), 0.3 * (k - (row + 1) / 2), 0.19 + foot / 2 } }
    pin:surface()
    pins[#pins + 1] = pin
  end
end
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("contact", { thickness = foot, radius = r, friction = mu, restitution = 0.3 })

scene:measure("fallen", function(s)
  local count = 0
  for _, pin in ipairs(pins) do
    local _, R = pin:attitude(s)
    if R[3][3] < math.cos(0.5) then count = count + 1 end
  end
  return count
end)
scene:measure("slip", function(s) return ball:velocity(s)[1] - r * ball:spin(s)[2] end, { unit = "m/s" })
scene:measure("speed of the ball", function(s) return ball:velocity(s)[1] end, { unit = "m/s" })
scene:output("frames", { width = 1280, height = 540, legend = false, from = { -1.6, -1.6, 1.1 }, look_at = { 0.3, 0, 0.1 } })
return scene
