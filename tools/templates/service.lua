-- NAME.lua, the test of NAME.c (hooke run --trust NAME.lua): three particles rise at 1 m/s from -0.9, -0.4 and 0.1 m, so
-- that 2 are below 0 at the start, 1 after half a second and none after a second. NAME_client.c asks.
local scene = hooke.scene { duration = 1, fps = 2, integrator = "leapfrog", dt = 0.05 }

for _, z in ipairs { -0.9, -0.4, 0.1 } do scene:particle { position = { 0, 0, z }, velocity = { 0, 0, 1 } } end
scene:service("./NAME.so", {})
scene:output("./NAME_client.so", { height = 0 })
scene:run()

local answers = {}
for line in io.lines("out/NAME/NAME.csv") do answers[#answers + 1] = line:match(",(%d+)$") end
local said = table.concat(answers, " ")
assert(said == "2 1 0", ("the service counts %s instead of 2 1 0"):format(said))
print("NAME: the service counts what is below")
