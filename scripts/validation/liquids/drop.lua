-- A plane drop, longer than wide by a tenth, swings by its surface tension.
local tank = require("_tank")
local validation = require("validation")

local R, sigma, step = 0.3, 162, 0.003 -- m, N/m, s

-- m^2: by how much it is longer than wide.
local function length_of(state, count)
  local sum, square = { 0, 0, 0 }, { 0, 0, 0 }
  for id = 1, count do
    for c, x in ipairs(state:position(id)) do sum[c], square[c] = sum[c] + x / count, square[c] + x * x / count end
  end
  return square[1] - sum[1] * sum[1] - square[3] + sum[3] * sum[3]
end

return validation.problem {
  title = "Oscillation of a drop",
  quantities = { { name = "half period", unit = "s", reference = math.pi / math.sqrt(6 * sigma / (1000 * R ^ 3)),
    source = "Rayleigh 1879, of a jet: w^2 = n (n^2 - 1) sigma/(rho R^3), n = 2" } },
  space = { 24, 32, 48 },
  noise = 0.02,
  tolerance = 0.025,
  why = "the curvature is smoothed over 1.3 cells, which makes the wave of two a circumference 1.5 % slow with 14 cells a radius",
  quick = { space = { 12, 14, 16 }, tolerance = 0.12 },
  solve = function(at)
    local scene, count = tank.scene { n = at.n, h = step, top = 1, duration = 2.1, with = { tension = sigma },
      inside = function(x, _, z) return ((x - 0.5) / 1.05) ^ 2 + ((z - 0.5) * 1.05) ^ 2 < R * R end }
    local times, swings, t0, y0 = {}, at.quick and 1 or 2, nil, nil
    validation.each(scene, step, 2.1 // step, function(state, t)
      local y = length_of(state, count)
      if y0 and y0 * y < 0 then times[#times + 1] = t0 + step * y0 / (y0 - y) end
      t0, y0 = t, y
      return #times > swings
    end)
    return (times[swings + 1] - times[1]) / swings
  end,
}
