-- A recording as a page holds it: positions, velocities and other numbers of the particles in blocks of frames
-- (tools/native/view/motion_code.h), topology, ids, series.
local page = require("page")
local json_text = require("common.view.json_text")
local marks = require("common.view.marks")
local series = require("common.view.series")
local shared = require("common.view.shared")
local solids = require("common.view.solids")

local encode = {}

local LEVELS = 65534 -- of a number, HK_MOTION_LEVELS: of positions
local COARSE = { [1] = 254, [3] = 1022 } -- of what is coloured or listed only: half a step is 2e-3 or 4.9e-4 of the range
local SAMPLES = 50000 -- numbers that the range of colours is chosen from, about
local BLOCK = 2000000 -- numbers of a block, about: what a browser unpacks at once

-- ---- the fields beside positions ----

-- A vector's range is one for all its components and symmetric, a number's its own.
local function fields_of(r)
  local list = {}
  for j, f in ipairs(r.fields) do
    list[j] = shared.field(f)
    list[j].get = function(k) return r:field(j, k) end
  end
  return list
end

local function widen(range, numbers, components)
  local low, high = page.range(numbers, components)
  for c = 1, components do
    range.low[c] = math.min(range.low[c] or math.huge, low[c])
    range.high[c] = math.max(range.high[c] or -math.huge, high[c])
  end
end

-- No number at all is a range of 0.
local function settle(range)
  for c = 1, #range.low do
    if range.low[c] > range.high[c] then range.low[c], range.high[c] = 0, 0 end
  end
end

local function widest(range)
  local most = 0
  for c = 1, #range.low do most = math.max(most, range.high[c] - range.low[c]) end
  return most
end

-- The least and the largest number that colours tell apart, from a sample of the motion; and of all numbers (of vectors: of the
-- sample's sizes), by which the page marks ends of the colours beyond which there are some.
local function range_of_colours(r, s)
  local all, frames = {}, math.max(1, r.frames // 50)
  local every = math.max(1, r:n(r.frames) * (r.frames // frames) // SAMPLES)
  for k = 1, r.frames, frames do
    local some = page.sizes(s.get(k), s.components, every)
    table.move(some, 1, #some, #all + 1, all)
  end
  local lowest, highest = s.low[1], s.high[1]
  if s.components > 1 then
    lowest, highest = math.huge, -math.huge
    for _, size in ipairs(all) do lowest, highest = math.min(size, lowest), math.max(size, highest) end
  end
  local least, most = page.colours_of(all, s.map)
  if lowest > highest then lowest, highest = least, most end -- there is no number
  return least, most, lowest, highest
end

local function largest_size(range)
  local square = 0
  for c = 1, #range.low do square = square + math.max(range.low[c] ^ 2, range.high[c] ^ 2) end
  return math.sqrt(square)
end

-- ---- streams ----

local function start_streams(r, fields, free)
  local streams = { { name = "position", components = 3, levels = LEVELS, get = function(k) return r:positions(k) end } }
  for _, f in ipairs(fields) do
    f.levels = COARSE[f.components] or COARSE[3]
    streams[#streams + 1] = f
  end
  table.move(free, 1, #free, #streams + 1, streams)
  for _, s in ipairs(streams) do
    s.low, s.high, s.texts, s.size = {}, {}, json_text.list(), 0
    for k = 1, r.frames do widen(s, s.get(k), s.components) end
    settle(s)
    s.step = widest(s) / s.levels
    s.encoder = page.encoder(s.low, s.step)
  end
  return streams
end

local function end_block(out, streams)
  for _, s in ipairs(streams) do
    local text = s.encoder:block()
    s.size = s.size + #text
    s.texts[#s.texts + 1] = out:add(text)
  end
end

local function stream_data(r, s)
  local least, most, lowest, highest
  if s.map then least, most, lowest, highest = range_of_colours(r, s) end
  return { name = s.name, label = s.label, painted = s.painted, unit = s.unit, components = s.components,
    map = s.map, low = json_text.list(s.low), high = json_text.list(s.high), step = s.step, texts = s.texts,
    error = s.encoder:error(), least = least, most = most, lowest = lowest, highest = highest,
    largest = largest_size(s) }
end

-- ---- topology and ids ----

local function packed_or_nil(out, indices)
  return #indices > 0 and out:add(page.indices(indices)) or nil
end

-- The indices of those that are held, of a byte for each particle.
local function held_indices(pins)
  local list = {}
  for at in pins:gmatch("()[^\0]") do list[#list + 1] = ("<I4"):pack(at - 1) end
  return table.concat(list)
end

-- Doubles as 32-bit floats.
local function floats(doubles)
  local list = {}
  for at = 1, #doubles, 8 do list[#list + 1] = ("<f"):pack((string.unpack("<d", doubles, at))) end
  return table.concat(list)
end

local function topology(r, out, k)
  local groups, radii = r:groups_and_radii(k)
  return { first = k - 1, edges = packed_or_nil(out, r:edges(k)), triangles = packed_or_nil(out, r:triangles(k)),
    pins = packed_or_nil(out, held_indices(r:pins(k))), groups = packed_or_nil(out, groups or ""),
    radii = packed_or_nil(out, floats(radii or "")) }
end

local function frames_of_block(r)
  local n = 1
  for k = 1, r.frames do n = math.max(n, r:n(k)) end
  return math.max(8, math.min(60, BLOCK // (3 * n)))
end

-- The origin of the page's positions, as recorded.js has it.
local function middle_of(stream)
  local middle = {}
  for c = 1, 3 do middle[c] = (stream.low[c] + stream.high[c]) / 2 end
  return middle
end

-- Writes the data of a recording to the page. The run as the page's data have it; nil and the reason.
-- more: title, summary (JSON text or nil), tick (a function called after each frame)
function encode.run(r, out, more)
  if r.frames == 0 then return nil, "it has no frames" end
  local free = marks.streams(r)
  local streams, per_block = start_streams(r, fields_of(r), free), frames_of_block(r)
  local run = { title = more.title, groups = json_text.list(r.groups),
    fps = r.fps, times = json_text.list(r.times), blocks = json_text.list(),
    populations = json_text.list(), topologies = json_text.list(), streams = json_text.list(),
    series = series.of(r.series or {}, r.units or {}), summary = more.summary and json_text.raw(more.summary) }
  local all_ids, ids, pins = {}, nil, nil
  for k = 1, r.frames do
    if (k - 1) % per_block == 0 then
      if k > 1 then end_block(out, streams) end
      table.insert(run.blocks, { first = k - 1 })
    end
    local now, held = r:ids(k), r:pins(k)
    if now ~= ids then
      table.insert(run.populations, { first = k - 1, n = #now // 4 })
      all_ids[#all_ids + 1], ids = now, now
    end
    if k == 1 or held ~= pins or r:topology_changed(k) then
      table.insert(run.topologies, topology(r, out, k))
      pins = held
    end
    for _, s in ipairs(streams) do s.encoder:add(s.get(k), not s.free and now or nil) end
    if more.tick then more.tick(k, r.frames) end
  end
  end_block(out, streams)
  run.ids = out:add(page.indices(table.concat(all_ids)))
  for k, s in ipairs(streams) do
    if not s.free then run.streams[k] = stream_data(r, s) end
  end
  run.marks = marks.page_data(r, free)
  run.solids = solids.of(r, out, middle_of(streams[1]))
  run.sizes = {}
  for _, s in ipairs(streams) do run.sizes[s.name] = s.size end
  return run
end

return encode
