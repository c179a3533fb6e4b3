-- A free asymmetric top that turns about all three axes, by kahan_li8: compositions of RATTLE steps keep their order, 8.
return require("_bodies").free_top("kahan_li8", {
  time = { 0.4, 0.2, 0.1 },
  order = { time = 8, within = 0.5 },
  tolerance = 1e-12,
  why = "order 8: 1e-11 at the finest step, of which the order leaves a tenth, and rounding",
  quick = { time = { 1.6, 0.8, 0.4 }, tolerance = 1e-5 },
})
