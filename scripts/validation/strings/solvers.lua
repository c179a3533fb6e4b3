-- Strands of springs hang from one end, longer by w L^2/(2 EA) than they lie, as every solver of linear systems finds them:
-- implicit steps come to rest there, whichever it is. Springs with lumped masses, half of one at the tip, have that
-- stretch for any n.
local validation = require("validation")

local EA, mu, L, g = 20, 0.3, 1.2, 9.81
local stretch = mu * g * L * L / (2 * EA)
local solvers = { "banded", "supernodal", "cholmod", "multigrid", "pcg", "umfpack" }

local quantities = {}
for k, name in ipairs(solvers) do
  quantities[k] = { name = "stretch by " .. name, unit = "m", reference = stretch, source = "closed form, w L^2/(2 EA)" }
end

local function hang(solver, n)
  local scene = hooke.scene { duration = 60, fps = 1, dt = 0.1, integrator = "backward_euler", solver = solver }
  local l, edges, tips = L / n, {}, {}
  for strand = 1, 3 do
    local above
    for k = 0, n do
      local id = scene:particle { position = { strand, 0, -k * l }, mass = mu * l * (k == n and 0.5 or 1) }
      if above then edges[#edges + 1] = { above, id } else scene:pin { id } end
      above, tips[strand] = id, id
    end
  end
  scene:force("gravity", { g = { 0, 0, -g } })
  scene:force("drag", { rate = 5 })
  scene:force("springs", { edges = edges, k = EA / l, rest = l })
  local s, sum = validation.rest(scene, 1, 1e-10, 60):state(), 0
  for _, tip in ipairs(tips) do sum = sum - s:position(tip)[3] / 3 end
  return sum - L
end

return validation.problem {
  title = "Hanging strands by every solver",
  quantities = quantities,
  space = { 8, 16, 32 },
  order = {},
  tolerance = 1e-8,
  noise = 1e-9,
  why = "what is left of the motion, 1e-10 m/s",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 4, 6, 8 }, tolerance = 1e-8 },
  solve = function(at)
    local found = {}
    for k, name in ipairs(solvers) do found[k] = hang(name, at.n) end
    return found
  end,
}
