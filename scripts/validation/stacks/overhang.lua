-- The k-th of four boxes, from above, stands out from the next one by a/(2 k), the harmonic overhang, of which a stack holds
-- 0.99 and not 1.01.
local validation = require("validation")
local boxes = require("_boxes")

local count = 4

local function sinks(h, duration, part)
  local places, x = {}, 0
  for k = 1, count do
    places[k] = { x, boxes.height(k) }
    x = x + part * boxes.a / (2 * (count - k))
  end
  local scene, list = boxes.scene(h, duration, 0.5, places)
  local s = scene:run():state()
  return boxes.height(count) - list[count]:position(s)[3]
end

local source = "the centre of the boxes above is over the edge of the next one (Paterson and Zwick 2009, Am. Math. Mon. 116, 19)"

return validation.problem {
  title = "A stack with the harmonic overhang stands at 0.99 and falls at 1.01 of it",
  quantities = {
    { name = "sinks at 0.99", unit = "m", reference = 0, scale = 1, source = source, tolerance = 1e-8 },
    { name = "falls at 1.01", reference = 1, source = source },
  },
  time = { 4e-3, 2e-3, 1e-3 },
  tolerance = 1e-7,
  noise = 1e-7,
  why = "what a solution leaves, 1e-8 m; a fall is 1 where the uppermost box is lower by a hundred times that",
  quick = { time = { 6e-3, 5e-3, 4e-3 } },
  solve = function(at)
    local duration = at.quick and 0.12 or 0.5
    return { sinks(at.h, duration, 0.99), sinks(at.h, duration, 1.01) > 1e-6 and 1 or 0 }
  end,
}
