-- Linear oscillators x'' = -g x' - w^2 x next to each other, in steps of 1 s: the scene on which
-- common/stability/stability_region.lua measures growth. Each is a mass of 1 kg on a spring without rest length, whose
-- force is linear for any displacement along its line. Each has two copies, with the start values (x, v) = (1, 0) and
-- (0, s), where s is the fastest rate.
local points = param("points", "1 0", "w (1/s) and g (1/s) of each oscillator")
local steps = param("steps", 24, "steps")

local scene = hooke.scene { duration = steps, fps = 1, dt = 1, tol = 1e30 }
local centre = scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:pin { centre }

local edges, k, damping = {}, {}, {}
for w, g in points:gmatch("(%S+) (%S+)") do
  local scale = math.max(1, tonumber(w), tonumber(g))
  for _, start in ipairs { { 1, 0 }, { 0, scale } } do
    local mass = scene:particle { position = { start[1], 0, 0 }, velocity = { start[2], 0, 0 }, mass = 1 }
    edges[#edges + 1], k[#k + 1], damping[#damping + 1] = { centre, mass }, tonumber(w) ^ 2, tonumber(g)
  end
end
scene:force("springs", { edges = edges, k = k, damping = damping, rest = 0 })
return scene
