-- NAME.lua, the test of NAME.c (hooke run --trust NAME.lua): a particle that no force acts on runs round a circle of
-- 2 m at its speed of 3 m/s, x = 2 cos(1.5 t).
local scene = hooke.scene { duration = 2, fps = 60, integrator = "rk4" }

local p = scene:particle { position = { 2, 0, 0 }, velocity = { 0, 3, 0 }, mass = 0.5 }
scene:constraint("./NAME.so", { particles = { p }, radius = 2 })

local s = scene:run():state()
local x = s:position(p)
-- rk4 at h = 1/60 s and the rate 1.5/s: (h rate)^4 = 4e-7 of some metres; the distance is projected to rounding
assert(math.abs(x[1] - 2 * math.cos(1.5 * s.t)) < 1e-6, "the particle does not keep its speed")
assert(math.abs(math.sqrt(x[1] ^ 2 + x[2] ^ 2 + x[3] ^ 2) - 2) < 1e-10, "the particle leaves the sphere")
print("NAME: the particle runs round the circle")
