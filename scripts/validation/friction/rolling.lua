-- A ball rolls down a plane without slipping: 5/7 g sin a; on a steeper one it slips, with g (sin a - mu cos a), and
-- friction turns it. The contact is soft, k N/m, so the ball sinks in by m g cos a/k and rolls on a radius that is smaller
-- by half of that: n is k, and what it converges to is rigid.
local validation = require("validation")

local g, mu, r, t_end, t_early = 9.81, 0.3, 0.05, 1.5, 0.5
local gentle, steep = math.rad(20), math.rad(60) -- rolling needs tan a < 7/2 mu = 1.05

local function ball(a, k, h)
  local scene = hooke.scene { duration = t_end, fps = 20, dt = h, integrator = "leapfrog" }
  scene:channel("spin", { size = 3 })
  local m = 0.1
  -- It starts at the depth at which the spring carries it.
  local p = scene:particle { position = { 0, 0, r - m * g * math.cos(a) / k }, mass = m }
  scene:force("gravity", { g = { g * math.sin(a), 0, -g * math.cos(a) } })
  scene:force("soft_walls", { planes = { 0, 0, 1, 0 }, radius = r, spin = "spin", stiffness = k, friction = mu,
    restitution = 0.5 })
  local early = scene:run { to = t_early }:state():velocity(p)[1]
  local s = scene:run():state()
  return (s:velocity(p)[1] - early) / (t_end - t_early), s:channel("spin", p), s:velocity(p)[1], early
end

return validation.problem {
  title = "A ball on a slope: rolling and slipping",
  quantities = {
    { name = "acceleration, rolling at 20 degrees", unit = "m/s^2", reference = 5 / 7 * g * math.sin(gentle),
      source = "closed form, 5/7 g sin a" },
    { name = "r w/v, rolling", reference = 1, source = "rolling without slipping" },
    { name = "acceleration, slipping at 60 degrees", unit = "m/s^2",
      reference = g * (math.sin(steep) - mu * math.cos(steep)), source = "closed form, g (sin a - mu cos a)" },
  },
  space = { 1e4, 2e4, 4e4 },
  space_label = "k, N/m",
  order = { space = 1 },
  tolerance = 1e-5,
  noise = 1e-6,
  why = "what the tangential spring still swings from the start, in a mean over 1 s",
  forces = { soft_walls = { "planes", "radius", "spin", "stiffness", "friction", "restitution" } },
  quick = { space = { 1e3, 2e3, 4e3 }, tolerance = 1e-3 },
  solve = function(at)
    local h = 1 / (100 * math.sqrt(at.n)) -- 20 steps in a swing of the contact
    local rolling, spin, v = ball(gentle, at.n, h)
    local slipping = ball(steep, at.n, h)
    return { rolling, r * spin[2] / v, slipping }
  end,
}
