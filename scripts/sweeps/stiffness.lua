-- stiffness.lua: the crossing of explicit and implicit. The plucked string of stiff_string.lua falls for a second while
-- its stiffness k goes from 1e2 to 1e8 N/m: an explicit method's step goes with 1/sqrt(k), and so its time with
-- sqrt(k), an implicit one's stays. stiffness-cost.png shows the seconds of the time loop (median of three, one case at
-- a time), and stiffness-error.png the distance to a run at half the step from a start that is off by 1e-10 of the
-- scene's size: what the explicit ones pay for at the stiff end is accuracy that nobody asked for.
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
