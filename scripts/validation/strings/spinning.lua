-- An elastic string turns about its end at the rate w, seen in the frame that turns with it: a pull of w^2 r on every part.
-- From (EA u')' + mu w^2 (s + u) = 0 with no force at the tip, s + u = sin(q s)/(q cos(q L)), q = w sqrt(mu/EA): the tip
-- is at tan(q L)/q, and the hub holds EA (1/cos(q L) - 1).
local validation = require("validation")

local EA, mu, L, w = 10, 0.5, 1, 3.5
local q = w * math.sqrt(mu / EA)

return validation.problem {
  title = "A spinning elastic string",
  quantities = {
    { name = "radius of the tip", unit = "m", reference = math.tan(q * L) / q, source = "closed form, tan(q L)/q" },
    { name = "force at the hub", unit = "N", reference = EA * (1 / math.cos(q * L) - 1), source = "closed form" },
  },
  space = { 8, 16, 32, 64 },
  order = { space = 2 },
  noise = 1e-11, -- of the speed at which it counts as resting, over the rate of the drag
  tolerance = 2e-7,
  why = "errors of order 2, 1e-4 at n = 64, leave those of order 4, (q L/n)^4 and some times that",
  forces = { springs = { "edges", "k", "rest" }, central = { "strength", "power" } },
  quick = { space = { 4, 8, 16 }, tolerance = 1e-3 },
  solve = function(at)
    local n, l = at.n, L / at.n
    local scene = hooke.scene { duration = 40, fps = 1, dt = 0.1 * l, integrator = "leapfrog" }
    local ids, edges = {}, {}
    for k = 0, n do
      ids[k] = scene:particle { position = { k * l, 0, 0 }, mass = mu * l * (k == n and 0.5 or 1) }
      if k > 0 then edges[k] = { ids[k - 1], ids[k] } end
    end
    scene:pin { ids[0] }
    scene:force("central", { strength = -w * w, power = 1 })
    scene:force("drag", { rate = 10 })
    scene:force("springs", { edges = edges, k = EA / l, rest = l })
    local s = validation.rest(scene, 1, 1e-12, 40):state()
    -- half of the first segment's mass belongs to the hub, where it does not move: the force there is that of the spring
    return { s:position(ids[n])[1], s:force("springs", ids[0])[1] }
  end,
}
