-- A cantilever's drop over its horizontal span under its own weight: what a picture of a hair tells of its stiffness.
local cantilever = require("_cantilever")

return cantilever.problem({
  title = "Drop over span of a heavy cantilever",
  space = { 16, 32, 64 },
  order = { space = 2 },
  tolerance = 2e-5,
  why = "what the errors of order 4 leave at w L^3/EI = 10; the first is published with six digits",
  with = { "angle_springs" },
  noise = 1e-10,
  quick = { space = { 4, 8, 16 }, tolerance = 3e-3 },
}, { { "w L^3/EI = 0.1", 0.0124996 }, { "w L^3/EI = 10", 1.066802 } }, "elastica", function(n, force)
  local ratio = {}
  for k, w in ipairs { 0.1, 10 } do
    local state, s = cantilever.equilibrium(n, force, cantilever.weight(w))
    local _, down, back = cantilever.tip(state, s, n)
    ratio[k] = down / (1 - back)
  end
  return ratio[1], ratio[2]
end)
