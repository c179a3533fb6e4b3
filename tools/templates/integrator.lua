-- NAME.lua, the test of NAME.c (hooke run --trust NAME.lua): a mass on a spring, x = 1 + 0.1 cos(2 t), with two steps:
-- the error falls with the method's order.
local function error_of(dt)
  local scene = hooke.scene { duration = 1, fps = 1, dt = dt }
  scene:integrator("./NAME.so", {})
  local a = scene:particle { position = { 0, 0, 0 } }
  local p = scene:particle { position = { 1.1, 0, 0 }, mass = 0.25 }
  scene:pin { a }
  scene:force("springs", { edges = { { a, p } }, k = 1, rest = 1 })
  return math.abs(scene:run():state():position(p)[1] - (1 + 0.1 * math.cos(2)))
end

local order = math.log(error_of(0.01) / error_of(0.005), 2)
assert(math.abs(order - 1) < 0.1, ("the order is %.3f instead of 1"):format(order)) -- h w = 0.02: the next term is small
print(("NAME: the order is %.3f"):format(order))
