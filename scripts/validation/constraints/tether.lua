-- Two masses fly apart until a cable between them is taut. What moves them apart then ends, as in a perfectly inelastic
-- impact along the cable; the rest turns them about their centre of mass, which flies on: a dumbbell of the angular momentum
-- that they had.
local validation = require("validation")

local m, L, t_end = { 1, 3 }, 1, 2 -- kg, m, s
local x0, v = { { 0, 0 }, { 0.5, 0 } }, { { -0.4, -0.6 }, { 0.2, 0.4 } } -- m, m/s
local total, reduced = m[1] + m[2], m[1] * m[2] / (m[1] + m[2])

-- The difference r + u t of the places has the length L, and from then on turns at (r x u)/L^2.
local r, u = { x0[2][1] - x0[1][1], x0[2][2] - x0[1][2] }, { v[2][1] - v[1][1], v[2][2] - v[1][2] }
local uu, ru, rr = u[1] ^ 2 + u[2] ^ 2, r[1] * u[1] + r[2] * u[2], r[1] ^ 2 + r[2] ^ 2
local taut = (-ru + math.sqrt(ru * ru + uu * (L * L - rr))) / uu
local turn = (r[1] * u[2] - r[2] * u[1]) / (L * L)
local angle = math.atan(r[2] + u[2] * taut, r[1] + u[1] * taut) + turn * (t_end - taut)

local function centre(c) return (m[1] * (x0[1][c] + v[1][c] * t_end) + m[2] * (x0[2][c] + v[2][c] * t_end)) / total end

return validation.problem {
  title = "Two masses caught by a cable",
  quantities = {
    { name = "x of the first mass at t = 2 s", unit = "m", reference = centre(1) - m[2] / total * L * math.cos(angle),
      scale = L, source = "closed form: momentum and angular momentum stay, the speed along the cable ends" },
    { name = "y of the first mass at t = 2 s", unit = "m", reference = centre(2) - m[2] / total * L * math.sin(angle),
      scale = L, source = "the same" },
    { name = "energy of the motion about the centre of mass", unit = "J", reference = reduced * (turn * L) ^ 2 / 2,
      source = "closed form, that of the turning" },
  },
  together = true,
  time = { 2e-2, 1e-2, 5e-3 },
  order = { time = 2, within = 0.8 },
  tolerance = 1e-4,
  noise = 1e-10,
  why = "order 2 of the turning; the impact is met inside its step",
  quick = { time = { 4e-2, 2e-2, 1e-2 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = t_end, fps = 5, dt = at.h, integrator = "leapfrog" }
    local p = {}
    for k = 1, 2 do
      p[k] = scene:particle { position = { x0[k][1], x0[k][2], 0 }, velocity = { v[k][1], v[k][2], 0 }, mass = m[k] }
    end
    scene:constraint("cables", { edges = { { p[1], p[2] } }, length = L })
    local s = scene:run():state()
    local first, a, b = s:position(p[1]), s:velocity(p[1]), s:velocity(p[2])
    return { first[1], first[2], reduced * ((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2) / 2 }
  end,
}
