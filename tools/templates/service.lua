-- NAME.lua, the test of NAME.c (hooke run --trust NAME.lua): the scene takes the service; hooke says that no plugin of it
-- asks for one yet.
local scene = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog", dt = 0.05 }

scene:particle { position = { 0, 0, 0 } }
scene:service("./NAME.so", {})
assert(scene:run():state().t == 0.1)
print("NAME: the service can be named")
