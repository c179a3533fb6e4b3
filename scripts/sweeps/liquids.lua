-- liquids.lua: grid or particles? The same water on the same particles by the corrector `liquid` on a grid, by `incompressible` and
-- by `sph`, in two problems with known answers (scripts/scenes/liquid_methods.lua has two more, which the handbook's which-liquid has
-- in a table). liquids-cost.png has a line for each method and problem: what it costs, the seconds of the time loop (the least of
-- two), and how far off it is.
return hooke.sweep {
  scene = "../scenes/liquid_methods.lua",
  params = { method = { "grid", "incompressible", "sph" }, problem = { "wave", "dam" }, n = { 12, 16, 24, 32 } },
  verify = false,
  repeats = 2,
  jobs = 1,
  timeout = 300,
  measures = { "steps", "step_wall_s", "error" },
  plots = {
    {
      name = "cost", title = "Liquids by a grid and by particles", measure = "error", over = "step_wall_s", along = "n",
      repeats = "least", xlabel = "time of the loop (s)", ylabel = "error by the known answer (1)",
      logx = true, logy = true,
    },
  },
}
