-- What orbits on surfaces of revolution have in common: the time between two rises of the height through a level, and
-- the angle that the particle goes round meanwhile.
local validation = require("validation")

local orbits = {}

-- The angle at time t between two steps, by the cubic of both angles and rates.
local function between(before, after, t)
  local d = after.t - before.t
  local u = (t - before.t) / d
  local w = 1 - u
  return w * w * (1 + 2 * u) * before.angle + u * u * (3 - 2 * u) * after.angle
    + u * w * d * (w * before.rate - u * after.rate)
end

-- A watcher: watch(state, t, particle) at every step; watch.period() and watch.advance() are means over all rises through
-- `level`. `from_start`: the start is one.
function orbits.watch(level, from_start)
  local rises, angles, last = validation.crossings(1), {}, nil
  local function look(_, s, t, particle)
    local x, v = s:position(particle), s:velocity(particle)
    local now = { t = t, angle = math.atan(x[2], x[1]), rate = (x[1] * v[2] - x[2] * v[1]) / (x[1] ^ 2 + x[2] ^ 2) }
    if last then now.angle = now.angle + 2 * math.pi * math.floor((last.angle - now.angle) / (2 * math.pi) + 0.5) end
    rises(t, x[3] - level, v[3])
    if from_start and not last then rises.times[1] = t end
    if #rises.times > #angles then angles[#angles + 1] = last and between(last, now, rises.times[#rises.times]) or now.angle end
    last = now
  end
  local function mean(list) return (list[#list] - list[1]) / (#list - 1) end
  return setmetatable({ period = function() return mean(rises.times) end, advance = function() return mean(angles) end },
    { __call = look })
end

return orbits
