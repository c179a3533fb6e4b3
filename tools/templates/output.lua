-- NAME.lua, the test of NAME.c (hooke run --trust NAME.lua): two particles of 1 kg and 3 kg that no force acts on; their
-- centre of mass moves at 3/4 m/s from 3/4 m.
local scene = hooke.scene { duration = 1, fps = 4, integrator = "leapfrog", dt = 0.05 }

scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:particle { position = { 1, 0, 0 }, velocity = { 1, 0, 0 }, mass = 3 }
scene:output("./NAME.so", {})
scene:run()

local lines = {}
for line in io.lines("out/NAME/NAME.csv") do lines[#lines + 1] = line end
assert(#lines == 6, ("%d lines instead of a head and 5 frames"):format(#lines))
local t, x = lines[6]:match("^([^,]*),([^,]*),")
assert(tonumber(t) == 1 and math.abs(tonumber(x) - 1.5) < 1e-14, "the last line is " .. lines[6]) -- rounding
print("NAME: the centre of mass is in the file")
