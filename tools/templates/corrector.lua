-- NAME.lua, the test of NAME.c (hooke run --trust NAME.lua): a particle flies down at 1 m/s from 1 m above the floor,
-- meets it at t = 1 s and comes back at e m/s.
local scene = hooke.scene { duration = 2, fps = 60, integrator = "leapfrog", dt = 0.01 }

local e, floor = 0.5, 0.25
local p = scene:particle { position = { 0, 0, floor + 1 }, velocity = { 0.3, 0, -1 }, mass = 2 }
scene:corrector("./NAME.so", { height = floor, e = e })

local s = scene:run():state()
local x, v = s:position(p), s:velocity(p)
-- the mirrored part of a step makes the bounce exact in time: what is left is rounding
assert(math.abs(x[3] - (floor + e * (s.t - 1))) < 1e-12, ("z is %.15g m"):format(x[3]))
assert(math.abs(v[3] - e) < 1e-15 and math.abs(x[1] - 0.3 * s.t) < 1e-12, "the bounce is not along z alone")
print("NAME: the particle bounces as restitution says")
