-- Arenstorf's orbit: a satellite between the earth and the moon, three loops past the moon's side, and back to where it
-- began; very sensitive. In the frame at rest, the earth and the moon on their circles; step control by `tol`.
local validation = require("validation")

local mu = 0.012277471
local T = 17.0652165601579625588917206249
local vy = -2.00158510637908252240537862224

return validation.problem {
  title = "Arenstorf's orbit of earth and moon",
  together = true,
  quantities = {
    { name = "x after a period", reference = 0.994,
      source = "Arenstorf 1963; Hairer, Norsett and Wanner I, II.0" },
    { name = "y after a period", reference = 0, scale = 1,
      source = "Arenstorf 1963; Hairer, Norsett and Wanner I, II.0" },
  },
  time = { 1e-10, 1e-11, 1e-12, 1e-13 },
  time_label = "tolerance",
  tolerance = 1e-5,
  why = "errors grow by more than 1e6 in the passages of the earth's vicinity",
  forces = { nbody = { "G", "sources", "among" } },
  quick = { time = { 1e-11, 1e-12, 1e-13 }, tolerance = 1e-4 },
  solve = function(at)
    local scene = hooke.scene { duration = T, fps = 4 / T, tol = at.h, integrator = "dopri5" }
    local earth = scene:particle { position = { -mu, 0, 0 }, mass = 1 - mu }
    local moon = scene:particle { position = { 1 - mu, 0, 0 }, mass = mu }
    local satellite = scene:particle { position = { 0.994, 0, 0 }, velocity = { 0, vy + 0.994, 0 }, mass = 1e-9 }
    for _, body in ipairs { { earth, -mu }, { moon, 1 - mu } } do
      scene:pin({ body[1] }, { path = function(t)
        local c, s, r = math.cos(t), math.sin(t), body[2]
        return r * (c - 1), r * s, 0, -r * s, r * c, 0
      end })
    end
    scene:force("nbody", { G = 1, sources = { earth, moon }, among = false })
    local x = scene:run():state():position(satellite)
    local c, s = math.cos(T), math.sin(T)
    return { c * x[1] + s * x[2], c * x[2] - s * x[1] }
  end,
}
