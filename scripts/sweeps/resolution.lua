-- resolution.lua: the same square of cloth as 16 x 16 to 128 x 128 particles: N springs in a row and N rows side by
-- side are together as stiff as one spring. An explicit step shrinks with the mesh width, and the number of springs
-- grows, so the time is proportional to N^3; the motion of the cloth converges. resolution-cost.png shows the time,
-- resolution-lowest.png the lowest point after half a second.
return hooke.sweep {
  scene = "../scenes/curtain.lua",
  params = { N = { 16, 24, 32, 48, 64, 96, 128 } },
  integrators = { "leapfrog", "stoermer", "rk4" },
  ["until"] = 0.5,
  jobs = 1,
  measures = { "steps", "step_wall_s", "lowest" },
  plots = {
    {
      name = "cost", title = "A curtain of N x N particles, 0.5 s", measure = "step_wall_s", over = "N",
      xlabel = "particles along a side", ylabel = "time of the loop (s)", logx = true,
    },
    {
      name = "lowest", title = "A curtain of N x N particles, 0.5 s", measure = "lowest", over = "N",
      xlabel = "particles along a side", ylabel = "lowest point (m)", logx = true,
    },
  },
}
