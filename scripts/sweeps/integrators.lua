-- integrators.lua: the classic comparison. Euler's method, the midpoint rule, the trapezoidal rule and the Runge-Kutta
-- method of order 4 compute a circle and a sine in 8, 16 and 32 steps per turn. Euler spirals outwards for any step, by
-- the factor sqrt(1 + h^2) per step; midpoint and trapezoid by about 1 + h^4/8, and rk4 inwards by h^6/144, which is
-- not visible. (Midpoint and trapezoid are the same method where the force is linear, as it is here.)
-- integrators-paths.png shows the paths, integrators-error.png the orders: 1, 2, 2 and 4.
return hooke.sweep {
  scene = "../scenes/oscillator.lua",
  params = { path = { "circle", "sine" }, n = { 8, 16, 32 } },
  integrators = { "euler", "midpoint", "trapezoid", "rk4" },
  measures = { "exact_error", "energy_drift", "force_evaluations" },
  paths = { 1 },
  plots = {
    {
      name = "paths", title = "Two turns of an oscillator in n steps a turn", path = 1, panels = { "path", "n" },
      curves = { circle = { "0:2*pi", "(cos(t)):(sin(t))" }, sine = { "0:4*pi", "(t):(sin(t))" } },
      range = { circle = { -2.5, 2.5, -2.5, 2.5 }, sine = { 0, 12.8, -4, 4 } },
    },
    {
      name = "error", title = "Error after two turns, m", measure = "exact_error", over = "n",
      xlabel = "steps a turn", ylabel = "distance to the exact solution (m)", logx = true,
    },
  },
}
