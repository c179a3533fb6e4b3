--[[
what: two stars pass each other between two steps, which half the step misses as well, with the energy conserved
right: closed form, Kepler's equation of the hyperbola
must: dopri5, esdirk4
]]
-- The bound: a tenth of the deflection, 2 GM/(b v) = 2 m/s for 0.47 s, of which each has half; b = 0.01 m, v = 100 m/s.
local scene = hooke.scene { duration = 1, fps = 10, tol = 1e-8, accuracy = 0.045 }
local a, b, nearest = 1e-4, 0.01, 0.53 -- m, m, s: half axis GM/v^2, distance of the asymptotes, time of the pericentre
local e, rate = math.sqrt(1 + (b / a) ^ 2), a ^ -1.5

local function sinh(H) return (math.exp(H) - math.exp(-H)) / 2 end
local function cosh(H) return (math.exp(H) + math.exp(-H)) / 2 end

local function anomaly(t) -- e sinh H - H = M by bisection, which cannot fail however steep
  local low, high = -30, 30
  for _ = 1, 80 do
    local H = (low + high) / 2
    if e * sinh(H) - H < rate * (t - nearest) then low = H else high = H end
  end
  return (low + high) / 2
end

local function apart(t)
  local H = anomaly(t)
  return a * (e - cosh(H)), b * sinh(H)
end

local H = anomaly(0)
local H_rate = rate / (e * cosh(H) - 1)
local x, y = apart(0)
local vx, vy = -a * sinh(H) * H_rate, b * cosh(H) * H_rate
scene:particle { position = { x / 2, y / 2, 0 }, velocity = { vx / 2, vy / 2, 0 }, mass = 0.5 }
scene:particle { position = { -x / 2, -y / 2, 0 }, velocity = { -vx / 2, -vy / 2, 0 }, mass = 0.5 }
scene:force("nbody", { G = 1 })
scene:exact(function(t)
  local u, w = apart(t)
  return u / 2, w / 2, 0, -u / 2, -w / 2, 0
end)
return scene
