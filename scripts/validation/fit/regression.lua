-- A straight line through numbers with noise: a free particle's start and velocity, which a regression gives in closed form.
local validation = require("validation")

local function measured(n) -- a + b t and waves as noise, of no known deviation
  local list = {}
  for k = 1, n do list[k] = { 2 * k / n, 2 - 3 * (2 * k / n) + 0.01 * math.sin(37 * k * k) } end
  return list
end

-- a, b, their deviations and their correlation (Bevington and Robinson, chapter 6)
local function closed(n)
  local list, st, stt, sy, sty, rest = measured(n), 0, 0, 0, 0, 0
  for _, x in ipairs(list) do st, stt, sy, sty = st + x[1], stt + x[1] ^ 2, sy + x[2], sty + x[1] * x[2] end
  local determinant = n * stt - st * st
  local a, b = (stt * sy - st * sty) / determinant, (n * sty - st * sy) / determinant
  for _, x in ipairs(list) do rest = rest + (x[2] - a - b * x[1]) ^ 2 end
  local variance = rest / (n - 2)
  return { a, b, math.sqrt(variance * stt / determinant), math.sqrt(variance * n / determinant), -st / math.sqrt(n * stt) }
end

local quantities = {}
for k, name in ipairs { "a", "b", "deviation of a", "deviation of b", "correlation" } do
  quantities[k] = { name = name .. " over the closed form", reference = 1, source = "closed form, linear regression" }
end

return validation.problem {
  title = "A regression and its covariance",
  quantities = quantities,
  space = { 10, 20, 40 },
  tolerance = 1e-7,
  noise = 1e-6,
  why = "differences of runs by 1e-5 of the parameters, whose rounding is 1e-11, and the tolerance of the least squares, 1e-6 squared",
  quick = { space = { 8, 10, 12 }, tolerance = 1e-6 },
  asks = function(at)
    local lines = { "t,x" }
    for _, x in ipairs(measured(at.n)) do lines[#lines + 1] = ("%.17g,%.17g"):format(x[1], x[2]) end
    return { command = "fit", words = { "--by", "a,b" }, data = table.concat(lines, "\n") .. "\n", script = [[
      local a, b = param("a", 1.5), param("b", -2)
      local scene = hooke.scene { duration = 2, fps = 10, integrator = "leapfrog", dt = 0.1 }
      local p = scene:particle { position = { a, 0, 0 }, velocity = { b, 0, 0 } }
      scene:measure("x", function(s) return s:position(p)[1] end)
      return scene]] }
  end,
  solve = function(at)
    local p, exact = at.found.minima[1].parameters, closed(at.n)
    return { p.a.value / exact[1], p.b.value / exact[2], p.a.deviation / exact[3], p.b.deviation / exact[4],
      p.a.correlation.b / exact[5] }
  end,
}
