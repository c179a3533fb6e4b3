-- The stiffness and the drag of a damped oscillator from 30 places with noise of a known deviation, by as many seeds as the level
-- says: the errors of the answers have the deviations that the fits state.
local validation = require("validation")

local w2, rate, sd = 40, 0.6, 0.01 -- 1/s^2, 1/s, m

local function exact(t)
  local wd = math.sqrt(w2 - rate * rate / 4)
  return math.exp(-rate * t / 2) * (math.cos(wd * t) + rate / (2 * wd) * math.sin(wd * t))
end

-- Normal numbers by Box and Muller from Lehmer's generator.
local function normal(seed)
  local x = (seed * 2654435761 + 12345) % 2147483647
  local function draw()
    x = x * 48271 % 2147483647
    return x / 2147483647
  end
  for _ = 1, 10 do draw() end
  return function() return math.sqrt(-2 * math.log(draw())) * math.cos(2 * math.pi * draw()) end
end

return validation.problem {
  title = "Deviations of a fit over many seeds",
  quantities = {
    { name = "error of k over its deviation, rms", reference = 1, source = "what a standard deviation is" },
    { name = "error of the drag over its deviation, rms", reference = 1, source = "what a standard deviation is" },
  },
  space = { 50, 100, 200 },
  space_label = "1/seeds",
  tolerance = 0.1,
  noise = 0.3,
  why = "200 seeds know an rms to 1/sqrt(400), 5 percent: twice that",
  timeout = 1200,
  quick = false,
  asks = function(at)
    local list = {}
    for seed = 1, at.n do
      local noise, lines = normal(seed), { "t,x,x_sd" }
      for k = 1, 30 do lines[k + 1] = ("%.17g,%.17g,%g"):format(k / 10, exact(k / 10) + sd * noise(), sd) end
      list[seed] = { command = "fit", words = { "--by", "k,rate" }, data = table.concat(lines, "\n") .. "\n", script = [[
        local k, rate = param("k", 38, "N/m", { min = 1 }), param("rate", 0.5, "1/s", { min = 0 })
        local scene = hooke.scene { duration = 3, fps = 10, integrator = "rk4", dt = 0.02 }
        local p = scene:particle { position = { 1, 0, 0 } }
        scene:force("central", { strength = k, per = "particle" })
        scene:force("drag", { rate = rate })
        scene:measure("x", function(s) return s:position(p)[1] end)
        return scene]] }
    end
    return list
  end,
  solve = function(at)
    local k, d = 0, 0
    for _, found in ipairs(at.found) do
      local p = found.minima[1].parameters
      k, d = k + ((p.k.value - w2) / p.k.deviation) ^ 2, d + ((p.rate.value - rate) / p.rate.deviation) ^ 2
    end
    return { math.sqrt(k / at.n), math.sqrt(d / at.n) }
  end,
}
