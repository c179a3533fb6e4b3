-- pendulum_chain.lua: a chain of rigid bars falls from the horizontal, swings through, and its free end cracks like a
-- whip; a weight hangs on it if wanted. No bar stretches: their lengths are equations, not springs, so the step is set by
-- the motion alone. `tension` is the force in the first bar, which holds the whole chain.
local n = param("n", 30, "bars", { min = 1 })
local weight = param("weight", 0, "mass of the last particle in terms of the others", { min = 0 })
local T = param("duration", 4, "s", { min = 0.1 })

local scene = hooke.scene { duration = T, fps = 60, integrator = "dopri5" }

local ids, edges, m, g = {}, {}, 0.3 / n, 9.81
for k = 0, n do
  local last = k == n and weight > 0
  ids[k] = scene:particle { position = { 1.5 * k / n, 0, 0 }, mass = last and weight * m or m }
  if k > 0 then edges[k] = { ids[k - 1], ids[k] } end
end
scene:pin { ids[0] }
scene:force("gravity", { g = { 0, 0, -g } })
scene:constraint("bars", { edges = edges })

scene:measure("tension", function(s) return s:constraint_forces("bars")[1] end, { unit = "N" })
scene:measure("tip speed", function(s)
  local v = s:velocity(ids[n])
  return math.sqrt(v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2)
end, { unit = "m/s" })
scene:measure("height", function(s) return s:position(ids[n])[3] end, { unit = "m" })
scene:measure("energy", function(s) return s:energy() end, { unit = "J" })
scene:output("frames", { width = 960, height = 720, color = "speed", range = { 0, 8 }, radius = 0.02,
  from = { 0, -4.6, -0.4 }, look_at = { 0, 0, -0.6 }, ground_height = -1.7 })
return scene
