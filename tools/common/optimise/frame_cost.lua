-- The scene's own cost in a transcription: the trapezium rule over its frames, as shooting takes it, of a measure of the state and of the
-- controls at the time of each. A frame between two knots, or at the second, is a function of the state at the first and of the values
-- at both: of the steps from there, whose derivatives a record has, and of the measure, whose slopes are differences and whose second
-- derivatives are differences of these. So each frame adds to the block of its segment E' B E + f_x . d2x/dz2, where B has the second
-- derivatives of the measure and E the first ones of what it is of (the chain rule; Nocedal and Wright, Numerical optimization, 8.2).
local derivative = require("common.gradient.derivative")
local quadratic = require("common.optimise.quadratic")

local frame_cost = {}
frame_cost.__index = frame_cost

-- The frames by segments, { last (step), t, weight, part (of the way from knot to knot), whole (it is the second knot) }, and that at the
-- start. times: of record:times(); parts: { first, last } steps of each segment. Or nil and why.
function frame_cost.of(case, record, times, parts)
  local self = { name = case.cost, record = record, parts = parts, parameters = case.parameters, frames = {} }
  local count, at, k = math.ceil(case.at * case.fps - 1e-6), 1, 1
  for i = 0, count do
    local function time(j) return math.min(j / case.fps, case.at) end
    local t = time(i)
    local weight = ((i > 0 and t - time(i - 1) or 0) + (i < count and time(i + 1) - t or 0)) / 2
    while at < #times and times[at] < t - 1e-6 * (times[2] - times[1]) do at = at + 1 end
    while k < #parts and at > parts[k].last + 1 do k = k + 1 end
    local begin, behind = times[parts[k].first], times[parts[k].last + 1]
    if i == 0 then self.start = { t = t, weight = weight }
    else
      self.frames[k] = self.frames[k] or {}
      table.insert(self.frames[k], { last = at - 1, t = t, weight = weight, part = (times[at] - begin) / (behind - begin),
        whole = at == parts[k].last + 1 })
    end
  end
  for j = 1, #parts do self.frames[j] = self.frames[j] or {} end
  return setmetatable(self, frame_cost)
end

-- The cost from these states at the first knots of segments, where `ends` are those behind them; or nil and why.
function frame_cost:value(from, ends)
  local sum, why = self.record:survey(self.name, self.start.t, from[1], false)
  if not sum then return nil, why end
  sum = sum * self.start.weight
  for k, part in ipairs(self.parts) do
    for _, frame in ipairs(self.frames[k]) do
      local X, value = ends[k], nil
      if not frame.whole then X, why = self.record:segment(part.first, frame.last, from[k], false) end
      if X then value, why = self.record:survey(self.name, frame.t, X, false) end
      if not value then return nil, why end
      sum = sum + frame.weight * value
    end
  end
  return sum
end

-- ---- slopes of the measure, by the numbers of the state and, behind them, by the controls ----

local function slope_at(self, frame, X)
  local value, slope = self.record:survey(self.name, frame.t, X, true)
  if not value then return nil, slope end
  local direct, why = self.record:direct(self.name, frame.t, X)
  if not direct then return nil, why end
  for j, by in ipairs(direct) do slope[#X + j] = by end
  return slope, value
end

local part_of_slopes = 1e-4 -- of the largest number of its kind, where slopes have errors of some 1e-10 (segments.lua)

local function largest(x, first, last)
  local most = 0
  for e = first, last do most = math.max(most, math.abs(x[e])) end
  return most > 0 and most or 1
end

local function reach_of(X, e)
  local half = #X // 2
  return part_of_slopes * (e > half and largest(X, half + 1, #X) or largest(X, 1, half))
end

-- Gives the controls the values u, and control j (nil: all) larger ones by its part of a difference; by how much, of each.
local function assign(self, u, j, side)
  local at, by = 0, {}
  for i, control in ipairs(self.parameters) do
    local count = #control.values
    local values = table.move(u, at + 1, at + count, 1, {})
    by[i] = part_of_slopes * largest(values, 1, count)
    local change = (j == nil or j == i) and side * by[i] or 0
    for k = 1, count do values[k] = values[k] + change end
    local fine, why = self.record:assign(i, control.name, values, derivative.control_change(values))
    if not fine then return nil, why end
    at = at + count
  end
  return by
end

-- The slopes at points { frame, X } with control j moved to one side, a list; or nil and why.
local function slopes_beside(self, points, u, j, side)
  local by, why = assign(self, u, j, side)
  local list = {}
  for i, point in ipairs(by and points or {}) do
    list[i], why = slope_at(self, point.frame, point.X)
    if not list[i] then return nil, why end
  end
  return by and list, by or why
end

-- Adds to B[e] the row of the differences.
local function add_row(B, e, more, less, by)
  local row = {}
  for i = 1, #more do row[i] = (more[i] - less[i]) / (2 * by) end
  B[e] = row
end

-- The rows of second derivatives of each point by the numbers of its state, on which the slope depends; or nil and why.
local function bend_by_state(self, point)
  local X, away = point.X, {}
  for e = 1, #X do away[e] = X[e] + reach_of(X, e) * (0.5 + e * 0.6180339887 % 0.5) * (e % 2 == 0 and 1 or -1) end
  local there, why = slope_at(self, point.frame, away)
  if not there then return nil, why end
  for e = 1, #X do
    if there[e] ~= point.slope[e] then
      local by, Y = reach_of(X, e), table.move(X, 1, #X, 1, {})
      Y[e] = X[e] + by
      local more, less
      more, why = slope_at(self, point.frame, Y)
      if not more then return nil, why end
      Y[e] = X[e] - by
      less, why = slope_at(self, point.frame, Y)
      if not less then return nil, why end
      add_row(point.B, e, more, less, by)
    end
  end
  return true
end

-- Rows of the state that only those of controls know.
local function complete(point, n)
  local size = #point.slope
  for j = n + 1, size do
    for e = 1, n do
      if not point.B[e] and point.B[j][e] ~= 0 then
        local row = {}
        for i = 1, size do row[i] = i > n and point.B[i][e] or 0 end
        point.B[e] = row
      end
    end
  end
end

-- Fills B of all points, rows by number; or nil and why.
local function bend(self, points, u)
  local n = #points[1].X
  for _, point in ipairs(points) do
    point.B = {}
    local fine, why = bend_by_state(self, point)
    if not fine then return nil, why end
  end
  for j in ipairs(self.parameters) do
    local more, by = slopes_beside(self, points, u, j, 1)
    if not more then return nil, by end
    local less, why = slopes_beside(self, points, u, j, -1)
    if not less then return nil, why end
    for i, point in ipairs(points) do add_row(point.B, n + j, more[i], less[i], by[j]) end
  end
  for _, point in ipairs(points) do complete(point, n) end
  return assign(self, u, nil, 0)
end

-- ---- what a frame adds to its segment ----

-- Of the columns of a part of a segment, by the state and by both values of each control at its ends, those by the values at both
-- knots: at the end of the part u is (1 - part) of the first and part of the second.
local function to_knots(list, n, controls, part)
  for j = 1, controls do
    local a, b = n + 2 * j - 1, n + 2 * j
    list[a], list[b] = list[a] + (1 - part) * list[b], part * list[b]
  end
  return list
end

-- E: for each number that the measure is of its derivatives by the columns, of knots.
local function reaches(point, n, controls)
  local E, columns = {}, n + 2 * controls
  for e = 1, n do
    local row = {}
    for c = 1, columns do row[c] = point.J[(c - 1) * n + e] end
    E[e] = to_knots(row, n, controls, point.frame.part)
  end
  for j = 1, controls do
    local row = {}
    for c = 1, columns do row[c] = c == n + 2 * j and 1 or 0 end
    E[n + j] = to_knots(row, n, controls, point.frame.part)
  end
  return E
end

local function add_to(sum, list, weight)
  for k = 1, #list do sum[k] = (sum[k] or 0) + weight * list[k] end
end

-- E' B E, of those rows of B that are there, symmetric.
local function curved(point, E, columns)
  local list = {}
  for k = 1, columns * columns do list[k] = 0 end
  for e, row in pairs(point.B) do
    local image, near = {}, E[e]
    for c = 1, columns do image[c] = 0 end
    for i, b in ipairs(row) do
      if b ~= 0 then
        for c = 1, columns do image[c] = image[c] + b * E[i][c] end
      end
    end
    for a = 1, columns do
      local half = near[a] / 2
      for c = 1, half ~= 0 and columns or 0 do
        list[(a - 1) * columns + c] = list[(a - 1) * columns + c] + half * image[c]
        list[(c - 1) * columns + a] = list[(c - 1) * columns + a] + half * image[c]
      end
    end
  end
  return list
end

-- The second derivatives of the part's steps, times the measure's slope, by knots.
local function of_steps(self, point, from, moves)
  local n, weight = #from, table.move(point.slope, 1, #from, 1, {})
  local controls = #self.parameters
  local columns = n + 2 * controls
  local X, J, H = self.record:segment(self.parts[point.k].first, point.frame.last, from, true, weight, moves)
  if not X then return nil, J end
  for side = 1, 2 do -- rows, then columns
    for r = 1, columns do
      local line = {}
      for c = 1, columns do line[c] = side == 1 and H[(r - 1) * columns + c] or H[(c - 1) * columns + r] end
      to_knots(line, n, controls, point.frame.part)
      for c = 1, columns do H[side == 1 and (r - 1) * columns + c or (c - 1) * columns + r] = line[c] end
    end
  end
  return H
end

-- All frames as points { frame, k, X, J, slope, value }, that at the start first; or nil and why.
local function points_of(self, from, ends, J)
  local n, controls = #from[1], #self.parameters
  local none = {}
  for k = 1, n * (n + 2 * controls) do none[k] = 0 end
  local start = setmetatable({ part = 0, whole = true, start = true }, { __index = self.start })
  local list = { { frame = start, k = 1, X = from[1], J = none } }
  for k, part in ipairs(self.parts) do
    for _, frame in ipairs(self.frames[k]) do
      local X, slopes = ends[k], J[k]
      if not frame.whole then X, slopes = self.record:segment(part.first, frame.last, from[k], true) end
      if not X then return nil, slopes end
      list[#list + 1] = { frame = frame, k = k, X = X, J = slopes }
    end
  end
  for _, point in ipairs(list) do
    point.slope, point.value = slope_at(self, point.frame, point.X)
    if not point.slope then return nil, point.value end
  end
  return list
end

-- At the controls u, from states at the first knots of segments, with the ends and derivatives J of these and the numbers that move before
-- each (nil: without the second derivatives of steps): { value, slopes (by the columns of each segment), G (its second derivatives without
-- those of steps), C (with them) }; or nil and why.
function frame_cost:derive(u, from, ends, J, moves)
  local points, why = points_of(self, from, ends, J)
  local n, controls, sum = #from[1], #self.parameters, { value = 0, slopes = {}, G = {}, C = {} }
  local columns = n + 2 * controls
  local fine = points
  if points then fine, why = bend(self, points, u) end
  if not fine then return nil, why end
  for k in ipairs(self.parts) do sum.slopes[k], sum.G[k], sum.C[k] = {}, {}, {} end
  for _, point in ipairs(points) do
    local E, slope, weight, k = reaches(point, n, controls), {}, point.frame.weight, point.k
    for c = 1, columns do
      slope[c] = 0
      for e, by in ipairs(point.slope) do slope[c] = slope[c] + by * E[e][c] end
    end
    sum.value = sum.value + weight * point.value
    add_to(sum.slopes[k], slope, weight)
    add_to(sum.G[k], curved(point, E, columns), weight)
    if moves and not point.frame.start then
      local H
      H, why = of_steps(self, point, from[k], moves[k])
      if not H then return nil, why end
      add_to(sum.C[k], H, weight)
    end
  end
  for k in ipairs(self.parts) do -- a segment without frames has none of it
    for c = 1, columns do sum.slopes[k][c] = sum.slopes[k][c] or 0 end
    for c = 1, columns * columns do sum.G[k][c], sum.C[k][c] = sum.G[k][c] or 0, sum.C[k][c] or 0 end
    sum.C[k] = quadratic.add(sum.C[k], 1, sum.G[k])
  end
  return sum
end

-- The slopes of segments as those by the values of all controls, one control after the other, and by the states at all knots.
function frame_cost:by_knots(slopes, n)
  local knots, gu, gx = #self.parts + 1, {}, {}
  for k = 1, knots * #self.parameters do gu[k] = 0 end
  for k = 1, knots do
    gx[k] = table.move(slopes[k] or {}, 1, n, 1, {})
    for e = 1, n do gx[k][e] = gx[k][e] or 0 end
  end
  for k, slope in ipairs(slopes) do
    for j = 1, #self.parameters do
      local at = (j - 1) * knots + k
      gu[at], gu[at + 1] = gu[at] + slope[n + 2 * j - 1], gu[at + 1] + slope[n + 2 * j]
    end
  end
  return gu, gx
end

return frame_cost
