-- NAME.lua, the test of NAME.c (hooke run --trust NAME.lua): a hanging cloth moves as it does with hooke's own direct
-- solver.
local function height(solver)
  local scene = hooke.scene { duration = 0.5, fps = 20, dt = 0.005, integrator = "implicit_trapezoid" }
  local cloth = scene:grid { nx = 6, ny = 6, width = 1, height = 1, mass = 0.2 }
  scene:pin { cloth:at(1, 6), cloth:at(6, 6) }
  scene:force("gravity", {})
  scene:force("springs", { edges = cloth:structural() .. cloth:shear(), k = 100, damping = 0.1 })
  scene:solver(solver, {})
  return scene:run():state():position(cloth:at(3, 1))[3]
end

local own, direct = height("./NAME.so"), height("cholmod")
-- a hundred steps, whose equations are solved to the tolerance of Newton's iteration, far below a micrometre
assert(math.abs(own - direct) < 1e-6, ("z is %.10g m instead of %.10g m"):format(own, direct))
print("NAME: the cloth hangs as with a direct solver")
