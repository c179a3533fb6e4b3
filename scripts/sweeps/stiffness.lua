-- stiffness.lua: the cost of explicit and implicit methods against stiffness. The plucked string of stiff_string.lua
-- falls for a second with stiffnesses k from 1e2 to 1e8 N/m: the step of an explicit method is proportional to
-- 1/sqrt(k), and so its time to sqrt(k), while the time of an implicit method is constant. stiffness-cost.png shows the
-- seconds of the time loop (median of three, one case at a time), and stiffness-error.png the distance to a run at half
-- the step from a start perturbed by 1e-10 of the scene's size: for large k the explicit methods are more accurate than
-- needed.
local ranges = require("ranges")

return hooke.sweep {
  scene = "../scenes/stiff_string.lua",
  params = { k = ranges.log(1e2, 1e8, 13) },
  integrators = {
    "leapfrog", "stoermer",
    { "bdf2", dt = 1 / 240, label = "bdf2, 1/240 s" },
    { "tr_bdf2", tol = 1e-3, label = "tr_bdf2, tol 1e-3" },
    { "xpbd:substeps=20", label = "xpbd, 20 substeps" },
  },
  ["until"] = 1,
  verify = true,
  repeats = 3,
  jobs = 1,
  timeout = 60,
  measures = { "steps", "step_wall_s", "verify_difference", "sag" },
  plots = {
    {
      name = "cost", title = "A plucked string, 1 s: what stiffness costs", measure = "step_wall_s", over = "k",
      xlabel = "stiffness of a spring (N/m)", ylabel = "time of the loop (s)",
    },
    {
      name = "error", title = "A plucked string, 1 s: what is reached", measure = "verify_difference", over = "k",
      xlabel = "stiffness of a spring (N/m)", ylabel = "distance to half the step (m)",
    },
  },
}
