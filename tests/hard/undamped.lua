--[[
what: no damping, 5,000 steps of a sixteenth of a second or 10,000 of half of it, 77 periods
right: closed form, the two modes of springs without rest length
must: stoermer5, blanes_moan, dopri5, rk4, stoermer
also: leapfrog dt=1/32; symplectic_euler dt=1/32
]]
-- The bound: a hundredth of the amplitude. The faster mode turns by w T = 485 rad; order 4 is off by (h w)^4/120 of it,
-- 4e-4, order 2 by (h w)^2/24, 0.2.
local scene = hooke.scene { duration = 300, fps = 16, tol = 1e-9, accuracy = 1e-2 }

scene:particles { positions = { { 0, 0, 0 }, { 0, 0, 0 }, { 1, 0, 0 } },
  velocities = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 1 } }, mass = 1 }
scene:pin { 1 }
scene:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = 1, rest = 0 })

-- Modes (1, r) of [2, -1; -1, 1]: w = 0.618 and r = 1.618 (the golden ratio), w = 1.618 and r = -0.618.
local slow, fast = (math.sqrt(5) - 1) / 2, (math.sqrt(5) + 1) / 2
scene:exact(function(t)
  local a = 1 / math.sqrt(5) -- (0, 1) is a times their difference
  local x = { a * math.cos(slow * t), -a * math.cos(fast * t) }
  local z = { a * math.sin(slow * t) / slow, -a * math.sin(fast * t) / fast }
  return 0, 0, 0, x[1] + x[2], 0, z[1] + z[2], fast * x[1] - slow * x[2], 0, fast * z[1] - slow * z[2]
end)
return scene
