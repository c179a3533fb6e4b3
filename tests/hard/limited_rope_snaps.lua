--[[
what: a mass falls into a slack rope that comes taut with a jerk, and swings at the limit of its strain
right: closed form up to the jerk; then a pendulum without its speed along the rope, by Runge's and Kutta's method
must: leapfrog, stoermer, rk4, dopri5, bdf2
also: leapfrog dt=1/60; rk4 dt=1/240; dopri5 tol=1e-6; symplectic_euler dt=1e-3; leapfrog dt=1e-4
]]
-- The bound: a hundredth of the 0.3 m by which the mass begins beside the pin. A correction at the end of a step is up
-- to a step late: order 2 in the angle, as the angular momentum is kept.
local g, R, x0 = 10, 1.1, 0.3
local scene = hooke.scene { duration = 1.2, fps = 60, tol = 1e-8, accuracy = 3e-3 }

local pin = scene:particle { position = { 0, 0, 0 }, mass = 1 }
local mass = scene:particle { position = { x0, 0, 0 }, mass = 2 }
scene:pin { pin }
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("strain_limit", { edges = { { pin, mass } }, rest = 1, limit = 0.1 })

local depth = math.sqrt(R * R - x0 * x0)
local fall = math.sqrt(2 * depth / g)
local function swing(t) -- the angle from the vertical, t after the jerk: a'' = -g/R sin a
  local a, w = math.asin(x0 / R), -g * fall * x0 / R / R
  local steps = math.ceil(t / 1e-3)
  local h = t / steps
  local function slope(q) return -g / R * math.sin(q) end
  for _ = 1, steps do
    local k1, w1 = w, slope(a)
    local k2, w2 = w + h / 2 * w1, slope(a + h / 2 * k1)
    local k3, w3 = w + h / 2 * w2, slope(a + h / 2 * k2)
    local k4, w4 = w + h * w3, slope(a + h * k3)
    a, w = a + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), w + h / 6 * (w1 + 2 * w2 + 2 * w3 + w4)
  end
  return a
end
scene:exact(function(t)
  if t <= fall then return 0, 0, 0, x0, 0, -g * t * t / 2 end
  local a = swing(t - fall)
  return 0, 0, 0, R * math.sin(a), 0, -R * math.cos(a)
end)
return scene
