-- Wind and points of contact, as a page holds them: two streams for each list, of places and of vectors, whose number may be
-- another one at every frame.
local json_text = require("common.view.json_text")

local marks = {}

local LEVELS = 4094 -- of a number: half a step is 1.2e-4 of the range, and these are shown only

-- The streams of a recording's lists, as encode.lua has them.
function marks.streams(r)
  local streams = {}
  for j in ipairs(r.marks or {}) do
    for half, name in ipairs { "places", "vectors" } do
      streams[#streams + 1] = { name = ("mark %d %s"):format(j, name), components = 3, levels = LEVELS, free = true,
        get = function(k) return (select(half, r:marks_of(j, k))) end }
    end
  end
  return streams
end

local function stream(s)
  return { name = s.name, components = 3, low = json_text.list(s.low), high = json_text.list(s.high), step = s.step,
    texts = s.texts }
end

-- The lists as the page's data have them, when the streams are written.
function marks.page_data(r, streams)
  local list = json_text.list()
  for j, m in ipairs(r.marks or {}) do
    local counts, totals = json_text.list(), json_text.list()
    for k = 1, r.frames do
      local places, _, total = r:marks_of(j, k)
      counts[k], totals[k] = #places // 24, total
    end
    list[j] = { name = m.name, kind = m.kind, counts = counts, totals = totals, places = stream(streams[2 * j - 1]),
      vectors = stream(streams[2 * j]) }
  end
  return list
end

return marks
