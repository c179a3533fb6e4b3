-- The study of one problem: which levels run, and what their values say of each quantity.
--
-- Space and time are refined one after the other: n over its levels at the finest h, and h over its levels at the
-- coarsest n, so that five runs do for three levels of each. What refining h adds at the coarsest n is added to the
-- value extrapolated in n; the product of both errors is neglected.
local convergence = require("common.validate.convergence")

local study = {}

local default_within = 0.3 -- an order of 2 is measured as 1.7 to 2.3 at levels that are not all asymptotic

-- The levels of a study: { space =, time = }, of which one may be nil.
function study.levels(description, quick)
  local short = quick and description.quick or {}
  return { space = short.space or description.space, time = short.time or description.time }
end

-- The arguments of `solve`, one per run; cell.space and cell.time are the places in the levels, nil where none.
function study.cells(levels, quick)
  local cells, space, time = {}, levels.space, levels.time
  for i = 1, space and #space or 0 do
    cells[#cells + 1] = { n = space[i], h = time and time[#time], space = i, time = time and #time, quick = quick }
  end
  for j = 1, time and #time or 0 do
    local known = space and j == #time -- the coarsest n at the finest h is there already
    if not known then
      cells[#cells + 1] = { n = space and space[1], h = time[j], space = space and 1, time = j, quick = quick }
    end
  end
  return cells
end

-- The values of quantity k along an axis, from coarse to fine.
local function along(cells, axis, levels, k)
  local list, other = {}, axis == "space" and "time" or "space"
  local fixed = levels[other] and (other == "time" and #levels.time or 1)
  for _, cell in ipairs(cells) do
    if cell[other] == fixed then list[cell[axis]] = cell.values[k] end
  end
  return list
end

local function sizes(axis, levels)
  local h = {}
  for k, x in ipairs(levels[axis]) do h[k] = axis == "space" and 1 / x or x end
  return h
end

local function judge_order(found, axis, q, faults)
  local expected, c = q.order[axis], found[axis]
  if not c then return end
  if c.doubt then
    faults[#faults + 1] = ("no regular convergence in %s: %s"):format(axis, c.doubt)
  elseif expected and c.order and math.abs(c.order - expected) > (q.order.within or default_within) then
    faults[#faults + 1] = ("order %.2f in %s, expected %g"):format(c.order, axis, expected)
  end
end

-- What the levels themselves say of the error of the finest one, relative: the grid convergence index of Roache (1998), 1.25
-- times what extrapolation added, of both axes. The extrapolated value is the better one. nil: an axis shows no order.
local function uncertainty(found)
  local sum = 0
  for _, axis in ipairs { "space", "time" } do
    local c = found[axis]
    if c and c.doubt then return nil end
    if c then sum = sum + math.abs(c.value - c.v[#c.v]) end
  end
  return 1.25 * sum / found.quantity.scale
end

local function judge(found, description, quick)
  local q = found.quantity
  found.value = found.space and found.space.value or found.time.value
  if found.space and found.time then found.value = found.value + found.time.value - found.time.v[#found.time.v] end
  found.error = math.abs(found.value - q.reference) / q.scale
  found.uncertainty = uncertainty(found)
  found.digits = convergence.digits(found.value, q.reference, q.scale)
  found.tolerance = quick and description.quick and description.quick.tolerance or q.tolerance
  if found.error > found.tolerance then
    table.insert(found.faults, ("off by %.2g, more than the %.2g allowed"):format(found.error, found.tolerance))
  end
  if not quick then
    judge_order(found, "space", q, found.faults)
    judge_order(found, "time", q, found.faults)
  end
end

-- Where the orders of two terms of the error are given, and the levels show the first, the value without both.
local function extrapolate_twice(found, axis, q)
  local first, second, c = q.order[axis], q.order[axis .. "_next"], found[axis]
  if not (first and second and c.order) or c.in_noise or math.abs(c.order - first) > (q.order.within or default_within) then return end
  c.value = convergence.of_two_terms(c.h, c.v, first, second)
end

-- Gives all quantities the order of the vector that they are.
local function join(list, axis, h)
  local vectors, noise = {}, 0
  for k, found in ipairs(list) do
    vectors[k] = found[axis].v
    noise = math.max(noise, found.quantity.noise * found.quantity.scale)
  end
  local common = convergence.together(h, vectors, noise)
  for _, found in ipairs(list) do
    local c = { h = h, v = found[axis].v, spread = found[axis].spread }
    for _, key in ipairs { "order", "at_least", "exact", "noise", "doubt", "in_noise" } do c[key] = common[key] end
    c.value = convergence.limit(h, c.v, common)
    found[axis] = c
  end
end

-- What the cells, with their values, say of each quantity: a list of
--   quantity, value, error (relative to the scale), digits, tolerance
--   uncertainty   what the levels alone say of the finest one's error, relative; nil: nothing
--   space, time   see convergence.of, with h and v
--   faults        texts; none: the quantity is right
function study.results(description, levels, cells, quick)
  local list = {}
  for k, q in ipairs(description.quantities) do list[k] = { quantity = q, faults = {} } end
  for _, axis in ipairs { "space", "time" } do
    local h = levels[axis] and sizes(axis, levels)
    for k, found in ipairs(h and list or {}) do
      local v = along(cells, axis, levels, k)
      found[axis] = convergence.of(h, v, found.quantity.noise * found.quantity.scale)
      found[axis].h, found[axis].v = h, v
    end
    if h and description.together then join(list, axis, h) end
    for _, found in ipairs(h and list or {}) do extrapolate_twice(found, axis, found.quantity) end
  end
  for _, found in ipairs(list) do judge(found, description, quick) end
  return list
end

return study
