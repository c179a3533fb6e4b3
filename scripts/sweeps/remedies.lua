-- remedies.lua: what it costs to hold a chain at its length, by four remedies: springs so stiff that steps have to be
-- short, implicit steps of stiff springs, and in the place of springs bars, or corrections after each step.
-- remedies-cost.png has a line for each, with the seconds of the time loop (the least of five, one case at a time) and the
-- distance to the chain that does not stretch, as its springs get four times as stiff or its steps half as long.
return hooke.sweep {
  scene = "../scenes/stiffness.lua",
  params = { remedy = { "shorter steps", "implicit", "bars", "correction" }, level = { 0, 1, 2, 3, 4, 5, 6 } },
  repeats = 5,
  jobs = 1,
  timeout = 60,
  measures = { "steps", "step_wall_s", "exact_error" },
  plots = {
    {
      name = "cost", title = "A chain of 20 links falls from 60 degrees, 1.5 s: four remedies", measure = "exact_error",
      over = "step_wall_s", along = "level", repeats = "least", xlabel = "time of the loop (s)",
      ylabel = "distance to a chain that does not stretch (m)", logx = true, logy = true,
    },
  },
}
