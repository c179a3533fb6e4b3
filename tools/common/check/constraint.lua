-- The tests of a constraint (hooke check): its Jacobian, speed and curvature against differences of its value, its
-- pattern, degenerate positions, and what a run with it keeps.
local actors = require("actors")
local actor = require("common.check.actor")
local population = require("common.check.population")
local whole_runs = require("common.check.whole_runs")

local ONE_SIDED = 1

-- Central differences with steps of 1e-5 of a metre: the error is h^2 of a third derivative, or rounding over h, both
-- below 1e-9; of second differences over 1e-3 s the same is below 1e-6 and 1e-9.
local H, FIRST = 1e-5, 1e-6
local DT, SECOND = 1e-3, 1e-4

local function value(a, count)
  local g, fine, said = actors.value(a, count)
  if not fine then error(("value failed: %s"):format(said), 0) end
  return g
end

-- Random states about the start, at a time that is not 0.
local function states(a, body)
  local start = actors.state(a)
  for seed = 1, 3 do
    local random = actor.random(seed)
    local x, v = actor.moved(start.x, random, 0.2), actor.moved(start.v, random, 1)
    actors.set(a, { t = 0.37, x = x, v = v })
    body(x, v, start)
  end
end

local function relative(off, size) return off / math.max(size, 1) end

-- g at x + s v, t + s.
local function at(a, count, x, v, s, moves)
  local there = {}
  for k = 1, #x do there[k] = x[k] + (moves and s * v[k] or 0) end
  actors.set(a, { t = 0.37 + s, x = there })
  local g = value(a, count)
  actors.set(a, { t = 0.37, x = x })
  return g
end

-- ---- properties ----

local function pattern(plugin, lines)
  actor.each(plugin, lines, function(a, _, run)
    local count, blocks = actors.equations(a)
    local again, second = actors.equations(a)
    if count ~= again or not actor.same(blocks, second) then
      return lines:wrong("count or pattern differ when they are asked again", "they change in `update` and `topology` only")
    end
    local n, seen, named = run:state().n, {}, {}
    for k = 1, #blocks, 2 do
      local row, column = blocks[k], blocks[k + 1]
      if row < 1 or row > count then return lines:wrong(("it names equation %d of %d"):format(row, count)) end
      if column < 1 or column > n then return lines:wrong(("it names particle %d of %d"):format(column, n)) end
      local key = row * (n + 1) + column
      if seen[key] then return lines:wrong(("equation %d names particle %d twice"):format(row, column)) end
      seen[key], named[row] = true, true
    end
    for row = 1, count do
      if not named[row] then return lines:wrong(("equation %d names no particle"):format(row)) end
    end
    if count == 0 then error("it has no equation in the scene made here", 0) end
  end)
end

local function matrix(a, count, blocks, n)
  local J, fine, said = actors.jacobian(a, #blocks // 2)
  if not fine then error(("jacobian failed: %s"):format(said), 0) end
  local full = {}
  for k = 1, count * 3 * n do full[k] = 0 end
  for b = 1, #blocks // 2 do
    local row, column = blocks[2 * b - 1], blocks[2 * b]
    for c = 1, 3 do full[(row - 1) * 3 * n + 3 * (column - 1) + c] = J[3 * (b - 1) + c] end
  end
  return full
end

local function jacobian(plugin, lines)
  local worst, size, where = 0, 0, nil
  actor.each(plugin, lines, function(a)
    local count, blocks = actors.equations(a)
    states(a, function(x)
      local n = #x // 3
      local J = matrix(a, count, blocks, n)
      for k = 1, 3 * n do
        local keep = x[k]
        x[k] = keep + H
        actors.set(a, { x = x })
        local above = value(a, count)
        x[k] = keep - H
        actors.set(a, { x = x })
        local below = value(a, count)
        x[k] = keep
        for e = 1, count do
          local measured = (above[e] - below[e]) / (2 * H)
          local off = math.abs(J[(e - 1) * 3 * n + k] - measured)
          size = math.max(size, math.abs(measured))
          if off > worst or off ~= off then worst, where = off, ("equation %d, particle %d"):format(e, (k + 2) // 3) end
        end
      end
      actors.set(a, { x = x })
    end)
  end)
  lines:most("J = dg/dx (differences over 1e-05 m)", relative(worst, size), FIRST,
    "compare `jacobian` with the derivative of `value`, and the order of the blocks with `pattern`", where)
end

local function speed(plugin, lines)
  local worst = 0
  actor.each(plugin, lines, function(a)
    local count = actors.equations(a)
    states(a, function(x, v)
      local above, below = at(a, count, x, v, H, false), at(a, count, x, v, -H, false)
      local stated = plugin.has.speed and actors.speed(a, count) or {}
      for e = 1, count do worst = math.max(worst, math.abs((above[e] - below[e]) / (2 * H) - (stated[e] or 0))) end
    end)
  end)
  lines:most(plugin.has.speed and "speed = dg/dt at fixed positions" or "g does not change with time, as it has no speed",
    worst, FIRST, "give the partial derivative of g by t in `speed`")
end

local function curvature(plugin, lines)
  local worst, size = 0, 0
  actor.each(plugin, lines, function(a)
    local count = actors.equations(a)
    states(a, function(x, v)
      local c, fine, said = actors.curvature(a, count)
      if not fine then error(("curvature failed: %s"):format(said), 0) end
      local g = {}
      for k = -2, 2 do g[k] = at(a, count, x, v, k * DT, true) end
      for e = 1, count do -- of order 4: angles of thin corners bend much
        local near, far = g[1][e] - 2 * g[0][e] + g[-1][e], g[2][e] - 2 * g[0][e] + g[-2][e]
        local measured = (16 * near - far) / (12 * DT ^ 2)
        size = math.max(size, math.abs(measured))
        local off = math.abs(c[e] - measured)
        if off > worst or off ~= off then worst = off end
      end
    end)
  end)
  lines:most("curvature = d^2 g/dt^2 without accelerations", relative(worst, size), SECOND,
    "it is v.(d^2 g/dx^2) v, with 2 v.d(dg/dt)/dx + d^2 g/dt^2 where g depends on t")
end

-- Every answer, for comparison.
local function answers(a)
  local count, blocks = actors.equations(a)
  local all = { actors.value(a, count), (actors.jacobian(a, #blocks // 2)), (actors.curvature(a, count)) }
  local flat = {}
  for _, list in ipairs(all) do
    for _, number in ipairs(type(list) == "table" and list or {}) do flat[#flat + 1] = number end
  end
  return flat
end

local function repeats(plugin, lines)
  for _, side in ipairs { "behind", "before" } do -- of the arrays' walls
    actor.each(plugin, lines, function(a)
      states(a, function()
        if not actor.same(answers(a), answers(a)) then
          lines:wrong("value, jacobian or curvature differ when they are asked again", "they depend on the view alone")
        end
      end)
    end, { side = side })
  end
end

local function degenerate(plugin, lines)
  actor.each(plugin, lines, function(a)
    for _, shape in ipairs(actor.degenerate(actors.state(a))) do
      actors.set(a, { x = shape[2] })
      if not actor.finite(answers(a)) then
        return lines:wrong(("not finite with %s particles"):format(shape[1]), "a distance may be 0: divide by none")
      end
    end
  end)
end

-- Forces of constraints do no work where g does not depend on t: without another force the kinetic energy stays, to the
-- error of rk4 at steps of 0.01 s.
local function run(plugin, lines)
  local drift, beyond = 0, 0
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s", setting.name)
    local fine, ended = pcall(function() return actor.scene(plugin, setting.values):run() end)
    if not fine then return lines:wrong("a run with it fails: " .. actor.plain(ended)) end
    local s = ended:summary()
    if s.verdict == "diverged" then return lines:wrong("a run with it diverges") end
    drift, beyond = math.max(drift, math.abs(s.energy.drift)), math.max(beyond, s.constraint_violation)
  end
  lines:most("a run keeps it, m", beyond, 1e-9, "look at jacobian and curvature")
  if not plugin.has.speed and plugin.flags & ONE_SIDED == 0 then
    lines:most("and does no work on the scene (energy drift)", drift, 1e-5, "look at curvature, and whether g depends on t")
  end
end

return function(plugin, report)
  local try = actor.watched(plugin, report)
  if not actor.starts(plugin, try) then return end
  try("count and pattern name equations and particles that there are, once", function(l) pattern(plugin, l) end)
  try("J = dg/dx", function(l) jacobian(plugin, l) end)
  try("speed = dg/dt", function(l) speed(plugin, l) end)
  try("curvature", function(l) curvature(plugin, l) end)
  try("it stays within its arrays and answers the same twice", function(l) repeats(plugin, l) end)
  try("finite at degenerate positions", function(l) degenerate(plugin, l) end)
  try("births and deaths", function(l) population.follows(plugin, l, answers) end)
  try("a run keeps it", function(l) run(plugin, l) end)
  whole_runs.habits(plugin, try)
end
