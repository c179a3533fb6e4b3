-- hair.lua: what it costs to move hair: straight hair of real stiffness falls for a second by implicit steps, by bars in
-- explicit steps, and by XPBD. hair-cost.png has a line for each, with the seconds of the time loop (the least of three,
-- one case at a time) and the distance to a run of half the steps. With 10 small steps a frame XPBD stretches by 18 %, with 80 by 0.4 %.
return hooke.sweep {
  scene = "../scenes/hair_methods.lua",
  params = { method = { "implicit", "bars", "xpbd" }, level = { 0, 1, 2, 3 }, strands = 100 },
  verify = true,
  repeats = 3,
  jobs = 1,
  timeout = 300,
  measures = { "steps", "step_wall_s", "verify_difference", "stretch" },
  plots = {
    {
      name = "cost", title = "100 strands of 32 segments, 1 s", measure = "verify_difference", over = "step_wall_s",
      along = "level", repeats = "least", xlabel = "time of the loop (s)", ylabel = "distance to half the step (m)",
      logx = true, logy = true,
    },
  },
}
