-- discretization.lua: one sheet as 16, 32 and 64 cells along a side, as squares, with alternating diagonals and as an
-- irregular mesh, by the numbers of its material and by one spring constant for all. discretization-sag.png and
-- discretization-period.png: the former lines meet, the latter do not.
return hooke.sweep {
  scene = "../scenes/discretization.lua",
  params = { N = { 16, 32, 64 }, mesh = { "regular", "alternating", "irregular" }, numbers = { "material", "raw" } },
  measures = { "sag", "period", "steps" },
  plots = {
    {
      name = "sag", title = "A sheet held along its border", measure = "sag", over = "N", logx = true,
      xlabel = "cells along a side", ylabel = "sag of the middle (m)",
    },
    {
      name = "period", title = "A sheet held along its border", measure = "period", over = "N", logx = true,
      xlabel = "cells along a side", ylabel = "first swing (s)",
    },
  },
}
