-- Plane waves in a net of squares with diagonals, the springs of cloth: lengthwise sqrt((k + k_d)/sigma), across
-- sqrt(k_d/sigma), which are its moduli C11 = k + k_d and C66 = k_d per area. A strip of three rows whose particles slide
-- along the wave, or across; on its rims masses and springs are halves.
local validation = require("validation")

local k, kd, sigma = 3, 1.2, 0.7 -- N/m, N/m, kg/m^2

local function period(modulus) return 2 / math.sqrt(modulus / sigma) end -- of the first mode between walls 1 m apart

local function measured(n, part, across)
  local T, a = period(across and kd or k + kd), 1 / n
  local h, steps = part * T, math.ceil(1.6 / part)
  local scene = hooke.scene { duration = steps * h, fps = 1 / h, dt = h, integrator = "leapfrog" }
  local id, walls, free, inner, rim, diagonal = {}, {}, {}, {}, {}, {}
  for i = 0, n do
    id[i] = {}
    for j = 0, 2 do
      local u = 1e-5 * math.sin(math.pi * i * a)
      id[i][j] = scene:particle { mass = sigma * a * a * (j == 1 and 1 or 0.5),
        position = { i * a + (across and 0 or u), j * a + (across and u or 0), 0 } }
      table.insert((i == 0 or i == n) and walls or free, id[i][j])
      if i > 0 then
        table.insert(j == 1 and inner or rim, { id[i - 1][j], id[i][j] })
        if j > 0 then
          diagonal[#diagonal + 1] = { id[i - 1][j - 1], id[i][j] }
          diagonal[#diagonal + 1] = { id[i][j - 1], id[i - 1][j] }
        end
      end
      if j > 0 then inner[#inner + 1] = { id[i][j - 1], id[i][j] } end
    end
  end
  scene:pin(walls)
  scene:pin(free, { axes = across and { 0, 1, 0 } or { 1, 0, 0 } })
  scene:force("springs", { edges = inner, k = k, rest = a, label = "inner" })
  scene:force("springs", { edges = rim, k = k / 2, rest = a, label = "rim" })
  scene:force("springs", { edges = diagonal, k = kd, rest = a * math.sqrt(2), label = "diagonal" })
  local zeros = validation.crossings()
  validation.each(scene, h, steps, function(s, t)
    local y, slope = 0, 0
    for i = 1, n - 1 do
      local x, v, mode = s:position(id[i][1]), s:velocity(id[i][1]), math.sin(math.pi * i * a)
      y = y + mode * (across and x[2] - a or x[1] - i * a)
      slope = slope + mode * v[across and 2 or 1]
    end
    return zeros(t, y, slope) == 3
  end)
  return zeros.times[3] - zeros.times[1]
end

return validation.problem {
  title = "Plane waves in a net of squares",
  quantities = {
    { name = "longitudinal period", unit = "s", reference = period(k + kd), source = "elastic sheet, C11 = k + k_d" },
    { name = "shear period", unit = "s", reference = period(kd), source = "elastic sheet, C66 = k_d" },
  },
  space = { 8, 16, 32 },
  time = { 1 / 50, 1 / 100, 1 / 200 },
  time_label = "step over period",
  order = { space = 2, time = 2 },
  tolerance = 1e-5,
  why = "order 2 in both, 4e-4 and 4e-5 at the finest; squares and products are left, and the amplitude's 1e-8",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 4, 8, 16 }, time = { 1 / 25, 1 / 50, 1 / 100 }, tolerance = 1e-3 },
  solve = function(at) return { measured(at.n, at.h, false), measured(at.n, at.h, true) } end,
}
