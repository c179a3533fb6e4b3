-- NAME.lua, the test of NAME.c (hooke run --trust NAME.lua): a particle every 0.25 s leaves the nozzle at 2 m/s and
-- lives for 0.6 s; the particle of the start stays.
local scene = hooke.scene { duration = 1.1, fps = 10, integrator = "leapfrog", dt = 0.01 }

scene:particle { position = { 9, 9, 9 }, mass = 3 }
scene:source("./NAME.so", { interval = 0.25, life = 0.6, velocity = { 0, 0, 2 } })

local s = scene:run():state()
local ids = s:ids()
-- born at 0, 0.25, 0.5, 0.75 and 1 s; at 1.1 s those of 0.5 s and later live
assert(#ids == 4 and ids[1] == 1 and ids[2] == 4, ("%d particles are left"):format(#ids))
for k, born in ipairs { 0.5, 0.75, 1 } do
  local z = s:position(ids[k + 1])[3]
  assert(math.abs(z - 2 * (s.t - born)) < 1e-12, ("particle %d is at %.15g m"):format(ids[k + 1], z)) -- rounding
end
print("NAME: particles are born and die on time")
