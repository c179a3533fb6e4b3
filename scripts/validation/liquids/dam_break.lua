-- A column of water, twice as high as wide, collapses: where its front is, by the column's width, at four of the times T = t sqrt(2 g/a) at
-- which Martin and Moyce (1952) saw it. Their diaphragm does not vanish at once: water without walls' friction is ahead by
-- 0.25 of T, at the first as at the last, which is counted in.
local tank = require("_tank")
local validation = require("validation")

local a, g, delay, step = 0.25, 9.81, 0.25, 0.002 -- m, m/s^2, of T, s
local data = { { 1.19, 1.44 }, { 1.98, 2.33 }, { 2.51, 3.00 }, { 2.98, 3.67 } }

-- By a: where half a cell's layer has come to.
local function front(state, count, n)
  local counts, last = {}, 0
  for id = 1, count do
    local k = math.floor(state:position(id)[1] * n)
    counts[k], last = (counts[k] or 0) + 1, math.max(last, k)
  end
  for k = last, 0, -1 do
    local part = (counts[k] or 0) / 4
    if part >= 0.5 then return (k + math.min(part, 1)) / n / a end
  end
end

local quantities = {}
for k, at in ipairs(data) do
  quantities[k] = { name = ("front at T = %g"):format(at[1]), reference = at[2], source = "Martin and Moyce 1952, n^2 = 2" }
end

return validation.problem {
  title = "The front of a dam break",
  quantities = quantities,
  space = { 24, 32, 48 },
  noise = 0.06,
  tolerance = 0.05,
  why = "the table is read to 2 %, and a layer of half a cell is 2 to 4 % of the way",
  quick = { space = { 16, 20, 24 }, tolerance = 0.08 },
  solve = function(at)
    local list = {}
    local scene, count = tank.scene { n = at.n, h = step, top = 2 * a, room = 3 * a, g = g, duration = 0.4,
      inside = function(x) return x < a end }
    for k, row in ipairs(data) do
      list[k] = front(scene:run { to = (row[1] - delay) * math.sqrt(a / (2 * g)) }:state(), count, at.n)
    end
    return list
  end,
}
