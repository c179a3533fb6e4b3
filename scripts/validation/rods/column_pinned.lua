-- A column pinned at both ends buckles under pi^2 EI/L^2.
local cantilever = require("_cantilever")

return cantilever.buckling({
  title = "Euler's column, pinned at both ends",
  tolerance = 5e-7,
  quick = { space = { 4, 8, 16 }, tolerance = 2e-3 },
  pinned = true,
}, "P L^2/EI", math.pi ^ 2, "Euler 1744, pi^2", function(scene, n, tip, P)
  scene:force("gravity", { g = { -2 * n * P, 0, 0 }, only = { tip }, label = "load" })
end)
