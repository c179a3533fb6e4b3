-- Chunks of a parallel_for in scenes of thousands of particles: where a force is local, so that a window of a chain has the
-- forces of the whole chain, but near the window's ends, each window of a long chain says what its part of the chain has
-- to be. A chunk that is left out, done twice, or written to another place shows, wherever the loop is cut.
local inspect = require("inspect")
local cases = require("common.check.force.cases")
local worst = require("common.check.force.worst")

local large = {}

local LONG, WINDOW, END = 5001, 1400, 100 -- particles; the forces of END at each end are not compared
local ROUNDING = 1e-9 -- of coordinates up to 5001 m
local DULL = 20 -- masses, numbers of tuples and lists repeat themselves after so many particles

-- The particles first to last of a shape, with the tuples among them, in their order.
local function window_of(shape, first, last)
  local part = { name = ("particles %d to %d of a %s"):format(first, last, shape.name), length = shape.length,
    positions = {} }
  for i = first, last do part.positions[i - first + 1] = shape.positions[i] end
  for _, list in ipairs { "edges", "triangles", "tetrahedra" } do
    part[list] = {}
    for _, tuple in ipairs(shape[list]) do
      local mapped, within = {}, true
      for m, i in ipairs(tuple) do
        mapped[m] = i - first + 1
        within = within and i >= first and i <= last
      end
      if within then part[list][#part[list] + 1] = mapped end
    end
  end
  return part
end

-- A moved state of n particles with two channels; of a window, that of its part.
local function state_of(shape, n, first, count)
  local x, v, y = {}, {}, {}
  for i = first, first + count - 1 do
    for c = 1, 3 do
      local noise = math.sin(12.9 * i + 4.1 * c) * 43758.5 % 1 - 0.5
      x[#x + 1], v[#v + 1] = shape.positions[i][c] + 0.3 * noise, math.cos(3.1 * i + c)
    end
  end
  for channel = 0, 1 do
    for i = first, first + count - 1 do y[channel * count + i - first + 1] = 0.5 + 0.2 * math.sin(i + channel) end
  end
  assert(first + count - 1 <= n)
  return { x = x, v = v, y = y }
end

-- The force on the particles first to last of the shape, in a scene of them alone; nil: it is refused.
local function force_in(plugin, lines, base, shape, first, last)
  local whole = first == 1 and last == #shape.positions
  local run = cases.open(plugin, cases.variant(base, whole and shape or window_of(shape, first, last)))
  if not run then return nil end
  local subject = inspect.open(run, plugin.name)
  local state = state_of(shape, #shape.positions, first, last - first + 1)
  if #inspect.state(subject).y ~= #state.y then return nil end
  lines:at("%s", lines.place) -- making it may have taken long
  inspect.set(subject, state)
  local F = inspect.force(subject, 0, 0)
  inspect.destroy(run)
  return F
end

-- How much the window's forces differ from those of the whole, but near the ends that the window does not share with it.
local function differ(F, part, first, last, n, left_out)
  local from, to = first == 1 and 1 or first + left_out, last == n and n or last - left_out
  local a, b = {}, {}
  for k = 3 * from - 2, 3 * to do
    a[#a + 1] = F[k]
    b[#b + 1] = part[k - 3 * (first - 1)]
  end
  return worst.difference(a, b)
end

local function is_local(plugin, lines, base)
  local short = cases.chain(3 * DULL)
  local whole = force_in(plugin, lines, base, short, 1, 3 * DULL)
  local part = whole and force_in(plugin, lines, base, short, DULL + 1, 3 * DULL)
  return part and differ(whole, part, DULL + 1, 3 * DULL, 3 * DULL, DULL // 2) <= ROUNDING
end

local function adds_up_in_chunks(plugin, lines)
  local base
  for _, case in ipairs(cases.list(plugin)) do base = base or (case.setting and case.few and case) end
  if not base or base.setting.each then return end
  lines:at("a chain of %d, and a window of it", 3 * DULL)
  if not is_local(plugin, lines, base) then return end
  local long, first = cases.chain(LONG), 1
  lines:at(long.name)
  local F = force_in(plugin, lines, base, long, 1, LONG)
  while F and first < LONG do
    local last = math.min(first + WINDOW - 1, LONG)
    if LONG - last < 3 * END then last = LONG end
    lines:at("a %s, and its particles %d to %d alone", long.name, first, last)
    local part = force_in(plugin, lines, base, long, first, last)
    local figure, text = 0, nil
    if part then figure, text = differ(F, part, first, last, LONG, END) end
    if figure > ROUNDING or figure ~= figure then
      return lines:wrong("in a long chain it is another force than in the parts of it: " .. (text or ""),
        "in parallel_for go from `begin` to `end` of each chunk, the last of which is shorter, and sum all chunks")
    end
    first = last == LONG and LONG or last + 1 - (2 * END + (last - 2 * END) % DULL)
  end
end

function large.try(plugin, report)
  if plugin.scene or plugin.has.step_limit then return end
  report:try("chunks of a long chain", function(lines) adds_up_in_chunks(plugin, lines) end)
end

return large
