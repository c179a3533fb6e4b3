--[[
what: two Lennard-Jones particles run at each other with 2,500 times the depth of the well and turn on the steep core
right: quadrature of the time along r, in this file
must: leapfrog, rk4, dopri5
also: leapfrog dt=1e-2; rk4 dt=1e-3; implicit_midpoint dt=1e-3; backward_euler dt=1e-3; bdf2 dt=1e-3
]]
-- The bound: at the core w = 3000 1/s and h = 1/20000 s. Methods of order 2 turn (h w)^2/12 = 2e-3 of its 2/w early or
-- late, 1e-6 s at 100 m/s, but those of order 1 the whole h/2 of it, 2.5e-3 m, and Euler more.
local scene = hooke.scene { duration = 0.06, fps = 20000, tol = 1e-9, accuracy = 1e-2 }
local speed, start, cut = 100, 3, 2.5 -- of one against the other; sigma = epsilon = m = 1

local function bare(r) return 4 * (r ^ -12 - r ^ -6) end
local slope = -24 * (2 * cut ^ -13 - cut ^ -7)
local function U(r) return r < cut and bare(r) - bare(cut) - (r - cut) * slope or 0 end
local E = speed ^ 2 / 4 -- the reduced mass is 1/2

local low, high = 0.3, 1 -- where it turns
for _ = 1, 200 do
  local r = (low + high) / 2
  if U(r) > E then low = r else high = r end
end
local turn = high
local count, inside, most = 1000, 0, math.sqrt(cut - turn)
for k = 1, count do -- integral of dr/sqrt(4 (E - U)) up to the cut-off, r = turn + s^2, by midpoints
  local s = most * (k - 0.5) / count
  inside = inside + 2 * s / math.sqrt(4 * (E - U(turn + s * s))) * most / count
end
scene:exact(function(t)
  local out = t - (start - cut) / speed - 2 * inside -- the time since it left
  if out < 0 then return end
  local r = cut + speed * out
  return -r / 2, 0, 0, r / 2, 0, 0
end)
scene:particles { positions = { { -start / 2, 0, 0 }, { start / 2, 0, 0 } },
  velocities = { { speed / 2, 0, 0 }, { -speed / 2, 0, 0 } }, mass = 1 }
scene:force("lennard_jones", {})
return scene
