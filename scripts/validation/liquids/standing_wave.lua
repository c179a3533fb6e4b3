-- The first standing wave in a tank half a wavelength wide, of three depths: the frequency by theory, sqrt(g k tanh(k d)).
-- Its amplitude a = 0.02 m changes it by 0.04 % at most (Tadjbakhsh and Keller 1960), 0.3 % at the least depth.
local tank = require("_tank")
local validation = require("validation")

local g, k, a, step = 9.81, math.pi, 0.02, 0.005
local look = 4 -- steps; between them a cubic is off by (w h)^4/384, 4e-7: a look at each took 32 cells beyond a script's 3 s
local depths = { 0.25, 0.5, 1 }

local function frequency(d) return math.sqrt(g * k * (1 - 2 / (math.exp(2 * k * d) + 1))) end

local function found(n, d, swings)
  local scene, count = tank.scene { n = n, h = step, top = d + 0.1, room = d + 0.25, g = g, duration = 4,
    level = function(x) return d + a * math.cos(k * x) end }
  local zero = validation.crossings()
  validation.each(scene, look * step, 4 / (look * step), function(state, t)
    local y, slope = 0, 0
    for id = 1, count do
      local x = state:position(id)[1]
      y, slope = y + math.cos(k * x), slope - k * math.sin(k * x) * state:velocity(id)[1]
    end
    return zero(t, y, slope) > swings
  end)
  return math.pi * swings / (zero.times[swings + 1] - zero.times[1])
end

local quantities = {}
for i, d in ipairs(depths) do
  quantities[i] = { name = ("frequency, %g m deep"):format(d), unit = "1/s", reference = frequency(d),
    source = "Lamb 1932, section 228: sqrt(g k tanh(k d))" }
end

return validation.problem {
  title = "Standing waves in a tank",
  quantities = quantities,
  space = { 16, 24, 32 },
  noise = 0.01,
  tolerance = 0.003,
  why = "the aim is 1e-3; chance in the places of particles moves the frequency by 1e-3 to 3e-3, and by 1e-2 if all of it is chance",
  quick = { space = { 12, 14, 16 }, tolerance = 0.02 },
  solve = function(at)
    local list = {}
    for i, d in ipairs(depths) do list[i] = found(at.n, d, at.quick and 2 or 4) end
    return list
  end,
}
