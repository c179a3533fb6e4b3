-- A square plate with simply supported borders swings in its first mode with w = 2 pi^2 sqrt(B/rho)/L^2, for any
-- Poisson's ratio: hinges on squares of alternating diagonals, whose corners slide across the plate. Particles on the
-- border are pinned; half a cell there bends freely.
local validation = require("validation")
local cloth = require("_cloth")

local density, B = 0.3, 0.02
local exact = math.sqrt(density / B) / math.pi

return validation.problem {
  title = "First period of a simply supported plate",
  quantities = {
    { name = "period", unit = "s", reference = exact,
      source = "w = 2 pi^2 sqrt(B/rho)/L^2 (Leissa, Vibration of Plates, 1969)" },
  },
  space = { 8, 16, 32 },
  order = { space = 2 },
  tolerance = 1e-3,
  why = "errors of order 2 leave those of order 4 and the ringing of other modes",
  forces = { hinges = { "triangles", "rigidity" } },
  quick = { space = { 4, 6, 8 }, tolerance = 0.1 },
  solve = function(at)
    local n = at.n
    local turn = 400 -- the rule's own error is (2 pi/turn)^2/12, 2e-5
    local h = exact / turn
    local steps = math.floor(2.5 * turn)
    local scene = hooke.scene { duration = steps * h, fps = validation.fps(h), dt = h, integrator = "implicit_midpoint" }
    local _, masses = cloth.squares(n, density)
    local speed = 1e-4 * 2 * math.pi / exact
    local border, mode = cloth.add(scene, n, masses, function() return 0 end, function(x, y)
      return speed * math.sin(math.pi * x) * math.sin(math.pi * y)
    end)
    local inner, edge = {}, {}
    for _, id in ipairs(border) do edge[id] = true end
    for k = 1, (n + 1) ^ 2 do
      if not edge[k] then inner[#inner + 1] = k end
    end
    scene:force("hinges", { triangles = require("sheet").alternating(n).faces, rigidity = B })
    scene:pin(border)
    scene:pin(inner, { axes = { 0, 0, 1 } })
    return cloth.period(scene, mode, h, steps)
  end,
}
