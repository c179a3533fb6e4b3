-- The step p of a quadratic program: least g.p + p.H p/2 with A p = -c and bounds of linear functions of p. Equations by
-- Schur's complement, bounds by the dual method of Goldfarb and Idnani (Math. Programming 27, 1983), which begins at the least
-- without them, adds the bound that is violated most, and knows when none can be kept.
local linear = require("common.fit.linear")

local quadratic = {}

local dependent = 1e-13 -- of the square of a row: what is left of it beside those before

function quadratic.times(M, x)
  local product = {}
  for k = 1, #M do product[k] = linear.dot(M[k], x) end
  return product
end

-- B x, where B is a matrix or a function that does that.
local function image_of(B, x)
  if type(B) == "function" then return B(x) end
  return quadratic.times(B, x)
end

-- x + part y
function quadratic.add(x, part, y)
  local sum = {}
  for k = 1, #x do sum[k] = x[k] + part * y[k] end
  return sum
end

local function triangles(L, b)
  local n, x = #b, {}
  for i = 1, n do
    x[i] = b[i]
    for k = 1, i - 1 do x[i] = x[i] - L[i][k] * x[k] end
    x[i] = x[i] / L[i][i]
  end
  for i = n, 1, -1 do
    for k = i + 1, n do x[i] = x[i] - L[k][i] * x[k] end
    x[i] = x[i] / L[i][i]
  end
  return x
end

-- A set of rows with Cholesky's factors of their products rows B rows^T.
local function new_set(B) return { B = B, rows = {}, images = {}, L = {} } end

-- Adds a row; or false and the parts of the rows before that it consists of.
local function include(set, row)
  local n, image, line, products = #set.rows, image_of(set.B, row), {}, {}
  local whole = linear.dot(row, image)
  local rest = whole
  for i = 1, n do
    products[i] = linear.dot(set.rows[i], image)
    line[i] = products[i]
    for k = 1, i - 1 do line[i] = line[i] - set.L[i][k] * line[k] end
    line[i] = line[i] / set.L[i][i]
    rest = rest - line[i] ^ 2
  end
  if rest <= dependent * whole or rest ~= rest then return false, triangles(set.L, products) end
  line[n + 1] = math.sqrt(rest)
  set.rows[n + 1], set.images[n + 1], set.L[n + 1] = row, image, line
  return true
end

local function without(set, j)
  local left = new_set(set.B)
  for i, row in ipairs(set.rows) do
    if i ~= j then include(left, row) end
  end
  return left
end

-- Of the rows A those that do not follow from others before them: their numbers, and a contradiction { row, others } where
-- one that follows asks for something else; negligible[i]: of c[i], as good as zero.
local function independent(B, A, c, negligible)
  local set, kept, contradiction = new_set(B), {}, nil
  for i = 1, #A do
    local fine, parts = include(set, A[i])
    if fine then kept[#kept + 1] = i else
      local off, size, others = c[i], math.abs(c[i]), {}
      for k, part in ipairs(parts) do
        off, size = off - part * c[kept[k]], size + math.abs(part * c[kept[k]])
        if math.abs(part) > 1e-6 then others[#others + 1] = kept[k] end
      end
      if math.abs(off) > math.max(negligible[i], 1e-7 * size) then contradiction = contradiction or { row = i, others = others } end
    end
  end
  return set, kept, contradiction
end

local function finite(x) return math.abs(x) < math.huge and math.abs(x) or 0 end

-- The bound that p violates most: which, the side (1: the lower one), and by how much; nil: none. Those that are `met` are violated by
-- rounding, which grows where rows nearly follow from each other: by more they are not met.
local function worst_of(bounds, p, met)
  local move, worst, which, side, is_met = bounds.values(p), 0, nil, nil, {}
  for _, bound in ipairs(met) do is_met[bound.k] = true end
  for k, u in ipairs(bounds.at) do
    local low, high = bounds.low[k] - (u + move[k]), u + move[k] - bounds.high[k]
    local margin = (is_met[k] and 1e-8 or 1e-12) * math.max(finite(bounds.low[k]), finite(bounds.high[k]), math.abs(u), 1e-300)
    if low - margin > worst then worst, which, side = low, k, 1 end
    if high - margin > worst then worst, which, side = high, k, -1 end
  end
  return which, side, worst
end

-- How far the multipliers of the set's bounds can go before one of them changes its sign, and of which row.
local function room_of(step, rows_change, goals)
  local room, which = math.huge, nil
  for i = goals + 1, #rows_change do
    if rows_change[i] > 0 and step.weight[i] / rows_change[i] < room then
      room, which = step.weight[i] / rows_change[i], i
    end
  end
  return room, which
end

-- Takes the violated bound into the set, dropping others on the way; false: no p keeps all.
local function take_bound(step, bounds, k, side, goals)
  local row, own = {}, 0
  for e, x in ipairs(bounds.row(k)) do row[e] = side * x end
  while true do
    local image, products = image_of(step.set.B, row), {}
    for i, other in ipairs(step.set.images) do products[i] = linear.dot(other, row) end
    local change = triangles(step.set.L, products)
    local z = image
    for i, other in ipairs(step.set.images) do z = quadratic.add(z, -change[i], other) end
    local slope, u = linear.dot(z, row), bounds.at[k] + bounds.values(step.p)[k]
    local missing = side > 0 and bounds.low[k] - u or u - bounds.high[k]
    local whole = slope > dependent * linear.dot(row, image) and missing / slope or math.huge
    local room, drop = room_of(step, change, goals)
    local length = math.min(whole, room)
    if length == math.huge then return false end
    if whole < math.huge then step.p = quadratic.add(step.p, length, z) end
    for i = 1, #change do step.weight[i] = step.weight[i] - length * change[i] end
    own = own + length
    if length == whole then
      if not include(step.set, row) then return false end
      step.weight[#step.set.rows] = own
      step.bound[#step.set.rows - goals] = { k = k, side = side }
      return true
    end
    step.set = without(step.set, drop)
    table.remove(step.weight, drop)
    table.remove(step.bound, drop - goals)
  end
end

-- B: the inverse of H, a matrix, or a function of x that gives B x; then `least` is -B g.
-- bounds: nil, or { at = u, low =, high =, values(p) -> changes of u, row(k) -> their row }.
-- Returns { p, multipliers (of A: H p + g + A^T m + the bounds' = 0), kept (rows of A), set, bound (those that p meets, { k, side },
-- the rows of the set behind those of A), prices (of each such bound, that of its row by its side), slope = g + A^T m + the bounds' },
-- and a contradiction among the rows or nil; or nil where no p keeps the bounds.
function quadratic.solve(B, g, A, c, negligible, bounds, least)
  local set, kept, contradiction = independent(B, A, c, negligible)
  local Bg, right, goals = least and quadratic.add(least, -2, least) or image_of(B, g), {}, #kept
  for i = 1, goals do right[i] = linear.dot(set.rows[i], Bg) - c[kept[i]] end
  local step = { set = set, kept = kept, weight = triangles(set.L, right), bound = {}, prices = {} }
  step.p = quadratic.add(Bg, -2, Bg) -- -B g
  for i = 1, goals do step.p = quadratic.add(step.p, step.weight[i], set.images[i]) end
  for _ = 1, bounds and 20 * #g or 0 do
    local k, side = worst_of(bounds, step.p, step.bound)
    if not k then break end
    if not take_bound(step, bounds, k, side, goals) then return nil, contradiction end
  end
  step.multipliers, step.slope = {}, g
  for i = 1, #A do step.multipliers[i] = 0 end
  for i, row in ipairs(step.set.rows) do
    if i <= goals then step.multipliers[kept[i]] = -step.weight[i]
    else step.prices[step.bound[i - goals].k] = -step.bound[i - goals].side * step.weight[i] end
    step.slope = quadratic.add(step.slope, -step.weight[i], row)
  end
  return step, contradiction
end

-- The least change by which the rows of the step's set change by `by`: of goals; bounds that are met stay met, or change by `beyond`, of
-- each bound (nil: none does). `base`: a change that is made beside it, the least one for reasons of its own; nil: none.
function quadratic.back(step, by, base, beyond)
  local right = {}
  for i, row in ipairs(step.set.rows) do
    local bound = step.bound[i - #step.kept]
    local change = bound and beyond and bound.side * (beyond[bound.k] or 0) or not bound and by[step.kept[i]] or 0
    right[i] = change + (base and linear.dot(row, base) or 0)
  end
  local weight, change = triangles(step.set.L, right), nil
  for i, image in ipairs(step.set.images) do
    change = change or quadratic.add(image, -1, image)
    change = quadratic.add(change, weight[i], image)
  end
  return change, weight
end

return quadratic
