--[[
what: two bodies on nearly straight orbits (e = 0.999) pass at a thousandth of their distance, ten times
right: closed form, Kepler's equation
must: dopri5
]]
-- The bound: a hundredth of the orbit. Between two encounters nothing happens for a thousand times their length.
local e, turns = 0.999, 10.3
local scene = hooke.scene { duration = turns * 2 * math.pi, fps = 4, tol = 1e-10, accuracy = 0.01 }

local function apart(t) -- E - e sin E = t by bisection
  local low, high = t - 1, t + 1
  for _ = 1, 80 do
    local E = (low + high) / 2
    if E - e * math.sin(E) < t then low = E else high = E end
  end
  local E = (low + high) / 2
  return math.cos(E) - e, math.sqrt(1 - e * e) * math.sin(E)
end

-- The start is at the apocentre, where they are 1 + e apart with the relative speed sqrt((1 - e)/(1 + e)).
local r, v = 1 + e, math.sqrt((1 - e) / (1 + e))
scene:particle { position = { -r / 2, 0, 0 }, velocity = { 0, -v / 2, 0 }, mass = 0.5 }
scene:particle { position = { r / 2, 0, 0 }, velocity = { 0, v / 2, 0 }, mass = 0.5 }
scene:force("nbody", { G = 1 })
scene:exact(function(t)
  local x, y = apart(t + math.pi)
  return x / 2, y / 2, 0, -x / 2, -y / 2, 0
end)
return scene
