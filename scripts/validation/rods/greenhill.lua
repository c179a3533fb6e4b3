-- A vertical hair buckles under its own weight where w L^3/EI = (9/4) j^2, j the first zero of J_-1/3 (Greenhill 1881).
local cantilever = require("_cantilever")

return cantilever.buckling({
  title = "A standing rod buckles under its own weight",
  tolerance = 1e-5,
  quick = { space = { 4, 8, 16 }, tolerance = 2e-3 },
}, "w L^3/EI", 7.83734743894, "Greenhill 1881", function(scene, _, _, w)
  scene:force("gravity", { g = { -w, 0, 0 } })
end)
