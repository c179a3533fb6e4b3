-- NAME.lua, the test of NAME.c (hooke run --trust NAME.lua): a particle of 1 kg starts at rest and is carried by the
-- wind, v = wind (1 - exp(-d t / m)).
local scene = hooke.scene { duration = 2, fps = 60, integrator = "rk4" }

local d, wind = 0.5, 3
local p = scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:force("./NAME.so", { wind = { wind, 0, 0 }, d = d })

local s = scene:run():state()
local x, v = s:position(p)[1], s:velocity(p)[1]
local gone = wind * (s.t - (1 - math.exp(-d * s.t)) / d)
-- rk4 at h = 1/60 s and the rate 0.5/s: (h rate)^4 = 5e-9 of some metres
assert(math.abs(x - gone) < 1e-8, ("x is %.12g m instead of %.12g m"):format(x, gone))
assert(math.abs(v - wind * (1 - math.exp(-d * s.t))) < 1e-8, "the velocity is not that of the formula")
print("NAME: the particle moves as the formula says")
