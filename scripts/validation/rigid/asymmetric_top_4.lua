-- A free asymmetric top that turns about all three axes, by blanes_moan: compositions of RATTLE steps keep their order, 4.
return require("_bodies").free_top("blanes_moan", {
  time = { 0.1, 0.05, 0.025 },
  order = { time = 4, within = 0.5 },
  tolerance = 1e-9,
  why = "errors of order 4 leave those of order 6",
  quick = { time = { 0.8, 0.4, 0.2 }, tolerance = 1e-3 },
})
