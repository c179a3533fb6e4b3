-- Ten boxes on each other, and a pyramid of 55, lie still.
local validation = require("validation")
local boxes = require("_boxes")

local function tower()
  local places = {}
  for k = 1, 10 do places[k] = { 0, boxes.height(k) } end
  return places
end

local function pyramid(n)
  local places = {}
  for k = 1, n do
    for j = 1, n + 1 - k do places[#places + 1] = { (j + (k - 1) / 2) * 1.05 * boxes.a, boxes.height(k) } end
  end
  return places
end

local function rest(h, duration, places)
  local scene, list = boxes.scene(h, duration, 0.5, places)
  return boxes.motion(scene:run():state(), list, places)
end

local source = "it is in equilibrium"

return validation.problem {
  title = "A tower and a pyramid of boxes lie still",
  quantities = {
    { name = "drift, ten boxes", unit = "m", reference = 0, scale = 1, source = source },
    { name = "speed, ten boxes", unit = "m/s", reference = 0, scale = 1, source = source },
    { name = "drift, pyramid", unit = "m", reference = 0, scale = 1, source = source },
    { name = "speed, pyramid", unit = "m/s", reference = 0, scale = 1, source = source },
  },
  time = { 4e-3, 2e-3, 1e-3 },
  tolerance = 1e-8,
  noise = 1e-8,
  why = "a solution may leave 1e-5 of half of the thickness, 1e-8 m; where all sticks it leaves 1e-3 of that",
  quick = { time = { 4e-3, 3e-3, 2e-3 }, tolerance = 1e-5 },
  solve = function(at)
    local duration = (at.quick and 6 or 100) * at.h
    local drift, speed = rest(at.h, duration, tower())
    return { drift, speed, rest(at.h, duration, pyramid(at.quick and 3 or 10)) }
  end,
}
