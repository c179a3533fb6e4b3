-- How far two recordings are apart over time: at each frame of the first, the nearest frame of the second.
local page = require("page")
local json_text = require("common.view.json_text")

local difference = {}

local function nearest(times, t, from)
  local k = from
  while k < #times and math.abs(times[k + 1] - t) <= math.abs(times[k] - t) do k = k + 1 end
  return k
end

-- { times, rms, most, largest }, m, of the particles that both have; where none is, null.
function difference.of(a, b)
  local d = { times = json_text.list(a.times), rms = json_text.list(), most = json_text.list(), largest = 0 }
  local other = 1
  for k = 1, a.frames do
    other = nearest(b.times, a.times[k], other)
    d.rms[k], d.most[k] = page.distance(a:positions(k), a:ids(k), b:positions(other), b:ids(other))
    if d.most[k] > d.largest then d.largest = d.most[k] end -- false for NaN
  end
  return d
end

return difference
