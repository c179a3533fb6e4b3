-- A column clamped at its foot and free at its head buckles under pi^2 EI/(4 L^2).
local cantilever = require("_cantilever")

return cantilever.buckling({
  title = "Euler's column, clamped and free",
  tolerance = 5e-7,
  quick = { space = { 4, 8, 16 }, tolerance = 2e-3 },
}, "P L^2/EI", math.pi ^ 2 / 4, "Euler 1744, pi^2/4", function(scene, n, tip, P)
  scene:force("gravity", { g = { -2 * n * P, 0, 0 }, only = { tip }, label = "load" })
end)
