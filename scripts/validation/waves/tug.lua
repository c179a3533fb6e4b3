-- How many steps a tug needs to the other end of a chain of n springs: after the first an explicit step takes it one
-- spring further, whatever its length; an implicit one takes it to the end at once. The springs have no length at rest, so
-- that a displacement of 1e-60 m, far below the rounding of a chain's length, is none of 0.
local validation = require("validation")

local function steps_to_the_end(n, method)
  local h = 0.01
  local scene = hooke.scene { duration = 2 * (n + 1) * h, fps = 1 / h, dt = h, integrator = method }
  local ids, edges = {}, {}
  for i = 0, n do
    ids[i] = scene:particle { position = { 0, 0, 0 }, velocity = { i == 0 and -1 or 0, 0, 0 }, mass = 1 }
    if i > 0 then edges[i] = { ids[i - 1], ids[i] } end
  end
  scene:force("springs", { edges = edges, k = 100, rest = 0 })
  local steps
  validation.each(scene, h, 2 * n + 1, function(s, t)
    steps = math.floor(t / h + 0.5)
    return s:position(ids[n])[1] ~= 0
  end)
  return steps
end

local source = "the stencil: in a step a mass depends on its neighbours; and on all others where a system is solved"

return validation.problem {
  title = "Steps that a tug needs along a chain",
  quantities = {
    { name = "symplectic_euler: steps for each spring", reference = 1, source = source },
    { name = "leapfrog: steps for each spring", reference = 1, source = source },
    { name = "backward_euler: steps", reference = 1, source = source },
  },
  space = { 4, 8, 16 },
  tolerance = 1e-12,
  why = "whole numbers",
  quick = { space = { 4, 8, 16 }, tolerance = 1e-12 },
  solve = function(at)
    return { (steps_to_the_end(at.n, "symplectic_euler") - 1) / at.n,
      (steps_to_the_end(at.n, "leapfrog") - 1) / at.n, steps_to_the_end(at.n, "backward_euler") }
  end,
}
