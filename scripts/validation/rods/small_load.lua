-- A cantilever bends in proportion to a small load: P L^3/(3 EI) at its tip, or its weight's w L^4/(8 EI).
local cantilever = require("_cantilever")

local P = 1e-3

return cantilever.problem({
  title = "Cantilever under small loads",
  space = { 16, 32, 64 },
  order = { space = 2 },
  tolerance = 1e-6,
  why = "large deflections take off 26/35 (P L^2/EI)^2 and less, 1e-6",
  noise = 1e-9,
  quick = { space = { 4, 8, 16 }, tolerance = 1e-4 },
}, { { "way down 3 EI/(P L^3)", 1 }, { "way down 8 EI/(w L^4)", 1 } }, "Euler and Bernoulli", function(n, force)
  local found = {}
  for k, load in ipairs { cantilever.pull(P, n), cantilever.weight(P) } do
    local state, s = cantilever.equilibrium(n, force, load)
    local _, down = cantilever.tip(state, s, n)
    found[k] = down / P * (k == 1 and 3 or 8)
  end
  return found[1], found[2]
end)
