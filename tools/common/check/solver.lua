-- The tests of a solver (hooke check): solutions of random sparse systems against the matrix itself, what it says of
-- them, matrices that it cannot solve, and patterns that come and go.
local solving = require("solving")
local actor = require("common.check.actor")
local whole_runs = require("common.check.whole_runs")

local DIRECT = 1e-10 -- residual of a direct method: rounding times the condition of the matrices here, below 1e4
local ASKED = 1e-8   -- asked of an iterative one

-- ---- matrices ----

-- A sparse matrix of `rows` block rows, blocks off the diagonal between i and a few others; plain tables.
-- kind: "definite", "indefinite", "unsymmetric".
local function make(rows, block, kind, seed, pattern)
  local random = actor.random(seed)
  local dense, entries = {}, {}
  local size = rows * block
  for r = 1, size do
    dense[r] = {}
    for c = 1, size do dense[r][c] = 0 end
  end
  local present = {}
  for i = 1, rows do present[i] = { [i] = true } end
  for i = 1, rows do
    for _, j in ipairs { i + 1, i + 3, i + 7 } do
      if j <= rows then present[i][j], present[j][i] = true, true end
    end
  end
  for i = 1, rows do
    for j in pairs(present[i]) do
      for a = 1, block do
        for b = 1, block do
          local r, c = block * (i - 1) + a, block * (j - 1) + b
          if kind == "unsymmetric" or r <= c then dense[r][c] = random() end
        end
      end
    end
  end
  for r = 1, size do
    for c = 1, r - 1 do if kind ~= "unsymmetric" then dense[r][c] = dense[c][r] end end
  end
  for r = 1, size do -- dominant on the diagonal, with signs that change where it may be indefinite
    local sum = 1
    for c = 1, size do if c ~= r then sum = sum + math.abs(dense[r][c]) end end
    dense[r][r] = (kind == "indefinite" and r % 3 == 0) and -sum or sum
  end
  local row_start, column, value = { 0 }, {}, {}
  for i = 1, rows do
    for j = 1, rows do
      if present[i][j] then
        column[#column + 1] = j - 1
        for a = 1, block do
          for b = 1, block do value[#value + 1] = dense[block * (i - 1) + a][block * (j - 1) + b] end
        end
      end
    end
    row_start[i + 1] = #column
  end
  entries.A = solving.matrix { rows = rows, block = block, row_start = row_start, column = column, value = value,
    symmetric = kind ~= "unsymmetric", pattern = pattern or seed + 1000 * rows }
  entries.dense, entries.size = dense, size
  return entries
end

local function right_side(size, seed)
  local b, random = {}, actor.random(seed)
  for k = 1, size do b[k] = random() end
  return b
end

-- |b - A x| / |b|
local function residual(m, b, x)
  local off, all = 0, 0
  for r = 1, m.size do
    local sum = b[r]
    for c = 1, m.size do sum = sum - m.dense[r][c] * x[c] end
    off, all = off + sum * sum, all + b[r] * b[r]
  end
  return math.sqrt(off / math.max(all, 1e-300))
end

-- The solver of a run of a scene, in every setting.
local function each(plugin, lines, body)
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s", setting.name)
    local scene = actor.scene(plugin, setting.values, { springs = true, gravity = true, integrator = "backward_euler" })
    local a = solving.open(scene:run { to = 0 }, "solver")
    local unsymmetric, indefinite, iterative = solving.flags(a)
    body(a, { unsymmetric = unsymmetric, indefinite = indefinite, iterative = iterative }, lines)
  end
end

local function kinds_of(can)
  local list = { "definite" }
  if can.indefinite then list[#list + 1] = "indefinite" end
  if can.unsymmetric then list[#list + 1] = "unsymmetric" end
  return list
end

local function solved(a, m, b, tolerance, new)
  local status, said = solving.factorize(a, m.A, new)
  if status ~= "ok" then error(("factorize %s: %s"):format(status, said), 0) end
  local x, info
  x, info, status, said = solving.solve(a, b, tolerance)
  if status ~= "ok" then error(("solve %s: %s"):format(status, said), 0) end
  return x, info
end

-- ---- properties ----

local function solves(plugin, lines)
  local worst, bound, where = 0, 0, nil
  each(plugin, lines, function(a, can)
    local tolerance = can.iterative and ASKED or 0
    bound = can.iterative and 1.01 * ASKED or DIRECT
    for _, kind in ipairs(kinds_of(can)) do
      for _, shape in ipairs { { 1, 3 }, { 2, 3 }, { 12, 3 }, { 7, 1 }, { 25, 3 }, { 3, 3 } } do
        local m = make(shape[1], shape[2], kind, 5 * shape[1] + shape[2])
        lines:at("a matrix of %d x %d numbers, %s", m.size, m.size, kind)
        local b = right_side(m.size, 3)
        local off = residual(m, b, (solved(a, m, b, tolerance, true)))
        if off > worst or off ~= off then worst, where = off, lines.place end
      end
    end
  end)
  lines:most("|b - A x| / |b|, of matrices that its flags promise", worst, bound,
    "multiply the solution by the matrix; blocks are row-major, columns rise within a row", where or false)
end

local function says_the_residual(plugin, lines)
  each(plugin, lines, function(a, can)
    if not can.iterative then return end
    for _, tolerance in ipairs { 1e-2, 1e-5, 1e-9 } do
      local m = make(20, 3, "definite", 11)
      local b = right_side(m.size, 4)
      local x, info = solved(a, m, b, tolerance, true)
      local off = residual(m, b, x)
      if off > 1.01 * tolerance then
        lines:wrong(("asked for %.0e it stops at %.2g"):format(tolerance, off), "go on until info->tolerance is reached")
      elseif math.abs(info.residual - off) > 0.1 * off + 1e-13 then
        lines:wrong(("it reports the residual %.2g, and it is %.2g"):format(info.residual, off))
      elseif info.iterations < 1 then
        lines:wrong("it reports no iterations")
      end
    end
  end)
end

-- New values of one pattern are factorized without analyze; another pattern, larger or smaller, comes with it.
local function patterns_come_and_go(plugin, lines)
  each(plugin, lines, function(a, can)
    local bound = can.iterative and 1.01 * ASKED or DIRECT
    local function try(m, new, what)
      lines:at("%s", what)
      local b = right_side(m.size, 6)
      local off = residual(m, b, (solved(a, m, b, can.iterative and ASKED or 0, new)))
      if off > bound or off ~= off then
        lines:wrong(("%s: |b - A x| / |b| = %.2g"):format(what, off),
          "factorize reads the values anew, and analyze the pattern")
      end
    end
    try(make(9, 3, "definite", 1, 77), true, "a first matrix")
    try(make(9, 3, "definite", 2, 77), false, "new values of the same pattern")
    try(make(20, 3, "definite", 3, 78), true, "a larger matrix")
    try(make(4, 3, "definite", 4, 79), true, "a smaller matrix")
    try(make(11, 1, "definite", 5, 80), true, "a matrix of blocks of one number")
  end)
end

local function simple_right_sides(plugin, lines)
  each(plugin, lines, function(a, can)
    local m = make(8, 3, "definite", 21)
    local zero = {}
    for k = 1, m.size do zero[k] = 0 end
    local x = solved(a, m, zero, can.iterative and ASKED or 0, true)
    if actor.largest(x) ~= 0 or not actor.finite(x) then
      lines:wrong("the solution for the right-hand side 0 is not 0", "|b| is 0: divide by none")
    end
    local b = right_side(m.size, 8)
    local one, two = solved(a, m, b, ASKED, false), solved(a, m, b, ASKED, false)
    if not actor.same(one, two) then
      lines:wrong("the same system has two solutions", "each solve begins anew, and sums have a fixed order")
    end
  end)
end

local function columns(plugin, lines)
  each(plugin, lines, function(a, can)
    local m = make(8, 3, "definite", 31)
    solved(a, m, right_side(m.size, 1), can.iterative and ASKED or 0, true)
    local all, single = {}, {}
    for k = 1, 4 do
      single[k] = right_side(m.size, 40 + k)
      for r = 1, m.size do all[4 * (r - 1) + k] = single[k][r] end
    end
    local x, status, said = solving.columns(a, all, 4)
    if not x then return end
    if status ~= "ok" then return lines:wrong("solve_columns fails: " .. said) end
    for k = 1, 4 do
      local own = {}
      for r = 1, m.size do own[r] = x[4 * (r - 1) + k] end
      local off = residual(m, single[k], own)
      if off > (can.iterative and 1e-6 or DIRECT) or off ~= off then
        return lines:wrong(("column %d of 4 of solve_columns: |b - A x| / |b| = %.2g"):format(k, off),
          "b and x are (rows x block) x columns, row-major")
      end
    end
  end)
end

-- A matrix that it does not promise: it may solve it, or say that it cannot, and nothing else.
local function refuses(plugin, lines)
  each(plugin, lines, function(a)
    for _, what in ipairs { "indefinite", "singular", "not finite" } do
      lines:at("a matrix that is %s", what)
      local m = make(6, 3, what == "indefinite" and what or "definite", 51)
      if what ~= "indefinite" then
        local value = what == "singular" and 0 or 0 / 0
        local list, start, column = {}, { 0 }, {}
        for i = 1, 6 do
          start[i + 1], column[i] = i, i - 1
          for k = 1, 9 do list[#list + 1] = k % 4 == 1 and (i == 3 and value or 1) or 0 end
        end
        m = { size = 18, dense = {}, A = solving.matrix { rows = 6, block = 3, row_start = start, column = column,
          value = list, symmetric = true, pattern = 5151 } }
        for r = 1, 18 do
          m.dense[r] = {}
          for c = 1, 18 do m.dense[r][c] = r == c and ((r + 2) // 3 == 3 and value or 1) or 0 end
        end
      end
      local b = right_side(m.size, 9)
      local status, said = solving.factorize(a, m.A, true)
      local step, x = "factorize", nil
      if status == "ok" then
        step = "solve"
        x, _, status, said = solving.solve(a, b, ASKED)
      end
      if status ~= "ok" then
        if said == "" then
          lines:wrong(("%s fails with a matrix that is %s and does not say why"):format(step, what), "use host->fail")
        end
      elseif not actor.finite(x) then
        lines:wrong(("a matrix that is %s has a solution that is no number, and solve says HK_OK"):format(what),
          "check the pivots, and return HK_NOT_CONVERGED or HK_NOT_FINITE")
      elseif residual(m, b, x) > 1e-6 then
        lines:wrong(("a matrix that is %s is solved wrongly, and solve says HK_OK"):format(what),
          "check the pivots, and return HK_NOT_CONVERGED")
      end
    end
  end)
end

local function describes(plugin, lines)
  each(plugin, lines, function(a)
    local text, ends = solving.describe(a)
    if text and not ends then lines:wrong("`describe` writes beyond its room", "use snprintf with the size") end
  end)
end

-- Against the scene's motion with hooke's own choice.
local function run(plugin, lines)
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s, in a scene of springs", setting.name)
    local options = { springs = true, gravity = true, integrator = "backward_euler", dt = 0.02 }
    local fine, own = pcall(function() return actor.scene(plugin, setting.values, options):run() end)
    if not fine then return lines:wrong("a run with it fails: " .. actor.plain(own)) end
    options.without = true
    local other = actor.scene(plugin, setting.values, options):run()
    local most = 0
    for id = 1, own:state().n do
      local p, q = own:state():position(id), other:state():position(id)
      for c = 1, 3 do most = math.max(most, math.abs(p[c] - q[c])) end
    end
    lines:most("a run ends where it does with hooke's own solver, m", most, 1e-6)
  end
end

return function(plugin, report)
  local try = actor.watched(plugin, report, solving)
  local fine = try("it starts", function(lines) each(plugin, lines, function() end) end)
  if not fine then return end
  try("it solves", function(l) solves(plugin, l) end)
  try("it reaches the residual that is asked for, and reports it", function(l) says_the_residual(plugin, l) end)
  try("matrices may change values and patterns", function(l) patterns_come_and_go(plugin, l) end)
  try("zero for a right-hand side of zeros, and the same twice", function(l) simple_right_sides(plugin, l) end)
  try("several right-hand sides at once", function(l) columns(plugin, l) end)
  try("what it cannot solve is said", function(l) refuses(plugin, l) end)
  try("its description ends within its room", function(l) describes(plugin, l) end)
  try("a run with it", function(l) run(plugin, l) end)
  whole_runs.habits(plugin, try, { springs = true, gravity = true, integrator = "backward_euler", keeps_nothing = true })
end
