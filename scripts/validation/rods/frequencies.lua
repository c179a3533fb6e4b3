-- The first three frequencies of a cantilever: it starts at rest in the shape of a mode, and the times at which the mode's
-- part vanishes give its period. The step falls with the square of the segments, as what is stable does, so that its error
-- is of order 4 in them.
local validation = require("validation")
local cantilever = require("_cantilever")

local roots = { 1.875104068712, 4.694091132974, 7.854757438238 }
local amplitude, swings = 1e-4, 2
local looks = 200 -- a period: cubics between them are good to 1e-8

local function mode(b)
  local function c(x) return (math.exp(x) + math.exp(-x)) / 2 end
  local function s(x) return (math.exp(x) - math.exp(-x)) / 2 end
  local ratio = (c(b) + math.cos(b)) / (s(b) + math.sin(b))
  return function(x) return c(b * x) - math.cos(b * x) - ratio * (s(b * x) - math.sin(b * x)) end
end

local function frequency(n, force, b)
  local shape, period = mode(b), 2 * math.pi / (b * b)
  local frame, frames = period / looks, math.ceil((swings + 0.5) * looks)
  local scene, s = cantilever.rod(n, force, { dt = frame / math.ceil(frame * 4 * n * n), duration = frames * frame,
    fps = 1 / frame, integrator = "leapfrog",
    curve = function(x) return x, amplitude * shape(x), 0 end })
  local falls = validation.crossings(-1)
  validation.each(scene, frame, frames, function(state, t)
    local part, rate = 0, 0
    for k = 1, n do
      local id, weight = cantilever.at(s, n, k), shape(k / n) * (k == n and 0.5 or 1)
      part = part + weight * state:position(id)[2]
      rate = rate + weight * state:velocity(id)[2]
    end
    return falls(t, part, rate) > swings
  end)
  return 2 * math.pi * (#falls.times - 1) / (falls.times[#falls.times] - falls.times[1])
end

local list = {}
for k, b in ipairs(roots) do
  list[k] = { ("w_%d"):format(k), b * b, unit = "rad/s", tolerance = ({ 2e-7, 3e-6, 1e-5 })[k],
    why = "what errors of orders 2 and 4 leave, (b/64)^6 times some" }
end

return cantilever.problem({
  title = "First three frequencies of a cantilever",
  space = { 16, 32, 64 },
  order = { space = 2 },
  noise = 1e-8,
  quick = { space = { 6, 12, 24 }, tolerance = 3e-2 },
}, list, "b^2 sqrt(EI/(rho A L^4)), cos b cosh b = -1", function(n, force)
  local found = {}
  for k, b in ipairs(roots) do found[k] = frequency(n, force, b) end
  return table.unpack(found)
end)
