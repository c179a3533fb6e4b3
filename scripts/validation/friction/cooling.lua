-- A ball between two walls loses the part 1 - e of its speed at each: at the impacts it obeys Haff's law of a cooling gas of
-- grains, v = v_0/(1 + t/tau), tau = L/(v_0 (1/e - 1)), and the n-th impact is at tau (e^-n - 1), without gravity.
local validation = require("validation")

local e, v0, L, n = 0.9, 3, 1, 12 -- m/s, m; from the middle, where the time begins half a crossing earlier
local tau = L / (v0 * (1 / e - 1))
local begun = L / 2 / v0
local t_end = tau * (e ^ -n - 1) - begun + L / (2 * v0 * e ^ n) -- the middle, after the n-th impact

return validation.problem {
  title = "Haff's law of cooling",
  quantities = {
    { name = "speed after 12 impacts", unit = "m/s", reference = v0 * e ^ n, source = "closed form, v_0 e^n" },
    { name = "tau from the speeds at both ends", unit = "s", reference = tau,
      source = "Haff 1983, J. Fluid Mech. 134, eq. 4.10: v = v_0/(1 + t/tau)" },
    { name = "place", unit = "m", reference = 0, scale = L, source = "closed form: in the middle between two impacts" },
  },
  time = { 1 / 50, 1 / 100, 1 / 200 },
  tolerance = 1e-10,
  noise = 1e-10,
  why = "free flight is exact in every step and impacts are found to rounding",
  quick = { time = { 1 / 25, 1 / 50, 1 / 100 }, tolerance = 1e-10 },
  solve = function(at)
    local scene = hooke.scene { duration = 30, fps = 10, dt = at.h, integrator = "leapfrog" }
    local p = scene:particle { position = { 0, 0, 0 }, velocity = { v0, 0, 0 }, mass = 0.1 }
    scene:corrector("obstacle", { position = { -L / 2, 0, 0 }, normal = { 1, 0, 0 }, restitution = e, label = "left" })
    scene:corrector("obstacle", { position = { L / 2, 0, 0 }, normal = { -1, 0, 0 }, restitution = e, label = "right" })
    local s = scene:run { to = t_end }:state()
    local speed = math.abs(s:velocity(p)[1])
    -- The mean of the n-th impact and the one after it is the present; the law holds at impacts.
    local crossing = L / speed
    return { speed, (t_end - crossing / 2 + begun) / (v0 / speed - 1), s:position(p)[1] }
  end,
}
