-- A net of 8 x 8 particles of three masses, that turns at 10/s and is shaken, is held by the limits of its springs alone:
-- momentum and angular momentum are what they were, after some 10^5 corrections.
local validation = require("validation")

local N, w, T = 8, 10, 1

local function particles()
  local list = {}
  for j = 0, N - 1 do
    for i = 0, N - 1 do
      local x, y, k = i / (N - 1) - 0.5, j / (N - 1) - 0.5, #list
      list[k + 1] = { position = { x, y, 0 }, mass = (1 + k % 3) / 100,
        velocity = { -w * y + math.sin(7.1 * k), w * x + math.cos(9.3 * k), math.sin(5.7 * k) } }
    end
  end
  return list
end

local function momenta(list)
  local p, l = 0, 0
  for _, q in ipairs(list) do
    p = p + q.mass * q.velocity[3]
    l = l + q.mass * (q.position[1] * q.velocity[2] - q.position[2] * q.velocity[1])
  end
  return p, l
end

local momentum, angular = momenta(particles())

return validation.problem {
  title = "A spinning net at the limits of its springs",
  quantities = {
    { name = "momentum along the axis", unit = "N s", reference = momentum, scale = 0.1, source = "Newton's third law" },
    { name = "angular momentum about the axis", unit = "N m s", reference = angular, source = "forces along the springs" },
  },
  time = { 1 / 60, 1 / 120, 1 / 240 },
  noise = 1e-11,
  tolerance = 1e-11,
  why = "rounding of some 1e5 moves of 1e-16",
  quick = { time = { 1 / 30, 1 / 60, 1 / 120 }, tolerance = 1e-11 },
  solve = function(at)
    local scene = hooke.scene { duration = T, fps = 10, dt = at.h, integrator = "leapfrog" }
    local ids, edges, list = {}, {}, particles()
    for k, q in ipairs(list) do ids[k] = scene:particle(q) end
    for j = 0, N - 1 do
      for i = 0, N - 1 do
        for _, step in ipairs { { 1, 0 }, { 0, 1 }, { 1, 1 }, { -1, 1 } } do
          local a, b = i + step[1], j + step[2]
          if a >= 0 and a < N and b < N then edges[#edges + 1] = { ids[j * N + i + 1], ids[b * N + a + 1] } end
        end
      end
    end
    scene:force("springs", { edges = edges, k = 0.1 })
    scene:corrector("strain_limit", { edges = edges, limit = 0.1, tolerance = 1e-4 })
    local s = scene:run():state()
    for k, q in ipairs(list) do q.position, q.velocity = s:position(ids[k]), s:velocity(ids[k]) end
    return { momenta(list) }
  end,
}
