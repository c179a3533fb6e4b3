-- Peirce's cantilever test: a strip is pushed over an edge until the chord from the edge to its end falls to 41.5 degrees;
-- then w L^3/EI = 8.0042 (textbooks' 8 is rounded).
local cantilever = require("_cantilever")

local function chord(n, force, w)
  local state, s = cantilever.equilibrium(n, force, cantilever.weight(w))
  local _, down, back = cantilever.tip(state, s, n)
  return math.atan(down, 1 - back)
end

return cantilever.problem({
  title = "Peirce's cantilever test",
  space = { 16, 32, 64 },
  order = { space = 2 },
  tolerance = 2e-6,
  why = "what the errors of order 4 leave; published with six digits",
  with = { "angle_springs" },
  noise = 1e-8,
  quick = { space = { 4, 8, 16 }, tolerance = 1e-3 },
}, { { "w L^3/EI", 8.00420 } }, "Peirce 1930; elastica", function(n, force)
  local x, y = { 7.9, 8.1 }, {}
  for k = 1, 3 do -- two loads, and the one at which the straight line between them has its zero
    y[k] = chord(n, force, x[k]) - math.rad(41.5)
    if k == 2 then x[3] = x[1] - y[1] * (x[2] - x[1]) / (y[2] - y[1]) end
  end
  return cantilever.zero_of_parabola(x, y)
end)
