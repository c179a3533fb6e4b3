-- The derivatives of a measure on both sides of a parameter's value, by whole runs: where it has a kink they differ, at a bound there
-- is one, and where something acts on the run that the derivative of its steps does not know (contact, correctors, cables)
-- they stand in its place. Runs above and below are extrapolated to the value itself (common/gradient/extrapolation.lua).
local case_process = require("common.run.case_process")
local derivative = require("common.gradient.derivative")
local extrapolation = require("common.gradient.extrapolation")
local parameters = require("common.run.parameters")
local process = require("process")

local sides = {}

-- The distances go from a part of the value down by halves; more are taken only where fewer do not tell.
local widest, batch, most = 8, 5, 15 -- in small changes of the parameter, 8e-3 of its value; levels at a time and in all
local enough = 1e-9 -- relative error of a derivative that needs no more runs
local known = 1e-2 -- beyond such an error, relative to the larger of both sides, one is not told

local below, above = -1, 1
sides.each = { below, above }
sides.name = { [below] = "below", [above] = "above" }

-- ---- in the process of a case: one run ----

local function execute(case)
  local scene, run = derivative.open(case, case.j, case.by)
  if not scene then return { failed = run } end
  require("sensitivity").to_rounding(run)
  local why
  run, why = derivative.advance(scene, case.at)
  if not run then return { failed = why } end
  local summary, value = run:summary(), run:measures()[case.of]
  why = derivative.grown(summary)
  if why then return { failed = why } end
  if not value then return { failed = ("the measure is not finite at t = %.9g s"):format(case.at) } end
  return { value = value, dt = summary.dt_max, steps = summary.steps,
    inaccurate = summary.verdict == "inaccurate" and summary.reason or nil }
end

-- The results of runs in which parameter j is larger by `by`: changes { j, by }.
local function results(case, changes)
  local list, n = {}, 0
  case_process.each(process.processors(), function()
    n = n + 1
    if not changes[n] then return nil end
    local one = { j = changes[n].j, by = changes[n].by, at_place = n, execute = execute }
    for _, key in ipairs { "scene", "params", "parameters", "of", "at", "integrator", "dt", "tol", "seed", "trust", "without" } do
      one[key] = case[key]
    end
    return one
  end, function(one, result) list[one.at_place] = result end)
  return list
end

-- ---- the two sides ----

-- How far the runs go on this side; nil: there is a bound.
local function reach(p, side)
  local scale = parameters.scale(p)
  local room = side == above and p.high - p.start or p.start - p.low
  if room < scale * 1e-6 then return nil end
  return math.min(widest * scale, room)
end

-- Takes the next levels of one side; whether it is told then, or cannot be.
local function widen(case, f, j, side, found)
  local p, changes = case.parameters[j], {}
  for k = 1, batch do
    local by = side * found.reach / 2 ^ (#found.h + k - 1)
    changes[k] = { j = j, by = by, h = math.abs((p.start + by) - p.start) } -- as the parameter differs after rounding
  end
  for k, result in ipairs(results(case, changes)) do
    if not result.value then
      found.unreached = result.failed
      return true
    end
    found.h[#found.h + 1], found.values[#found.values + 1] = changes[k].h, result.value
  end
  local told = extrapolation.side(f, side, found.h, found.values)
  found.slope, found.error, found.jump, found.size = told.slope, told.error, told.jump, told.size
  return found.error <= enough * math.abs(found.slope) or #found.h >= most
end

local function side_of(case, f, j, side)
  local found = { h = {}, values = {}, reach = reach(case.parameters[j], side) }
  if not found.reach then return { bound = true } end
  repeat local last = widen(case, f, j, side, found) until last
  return found
end

-- What both sides say: "smooth", "kink" (two derivatives), "bound" (one), "jump" (none) or "unknown".
local function kind_of(both)
  local size, open = 0, 0
  for _, side in ipairs(sides.each) do
    local s = both[side]
    if not s.bound then open = open + 1 end
    if s.unreached then return "unknown" end
    if s.jump then return "jump" end
    size = math.max(size, math.abs(s.slope or 0))
  end
  for _, side in ipairs(sides.each) do
    local s = both[side]
    if not s.bound and s.error > known * size and s.error * s.reach > 1e-9 * s.size then return "unknown" end
  end
  if open < 2 then return open == 1 and "bound" or "unknown" end
  local apart = math.abs(both[above].slope - both[below].slope)
  return apart <= 3 * (both[above].error + both[below].error) + 1e-7 * size and "smooth" or "kink"
end

-- case: scene, params, parameters, of, at, integrator, dt, tol, seed, trust, without. At its value: { value, dt, steps, inaccurate } or
-- { failed }.
function sides.here(case) return results(case, { { j = 0, by = 0 } })[1] end

-- Of parameter j, beside the measure f at its value: { kind, [-1] = { slope, error, jump, bound, unreached }, [1] = likewise }.
function sides.of(case, f, j)
  local both = {}
  for _, side in ipairs(sides.each) do both[side] = side_of(case, f, j, side) end
  both.kind = kind_of(both)
  return both
end

function sides.tells(both) return both.kind == "smooth" or both.kind == "kink" or both.kind == "bound" end

local part_left = 0.75 -- of how far both sides are apart, with half the step, of a kink that is the scene's

-- Adds what half the step does, by those that `finer` has there: by_steps of each side, `gain` times the change; and of_steps where
-- the kink is one of the steps: how far both sides are then apart.
function sides.refine(both, finer, gain)
  for _, side in ipairs(sides.each) do
    local s, half = both[side], finer[side]
    if s.slope and half.slope and sides.tells(finer) then s.by_steps = gain * math.abs(half.slope - s.slope) end
  end
  if both.kind ~= "kink" or not sides.tells(finer) then return end
  local apart = math.abs(finer[above].slope - finer[below].slope)
  if apart < part_left * math.abs(both[above].slope - both[below].slope) then both.of_steps = apart end
end

-- Whether a parameter is so near its bound that differences to both sides leave it.
function sides.at_bound(p) return p.values == nil and not derivative.fits(p) end

-- Reasons for which the derivative of the steps is refused, and whole runs tell it.
local replaced = { "is contact, whose begin and end", "acts on one side only", "^corrector '[^']*' acts on the steps",
  "remembers what happened" }

function sides.replace(reason)
  for _, words in ipairs(replaced) do
    if reason:find(words) then return true end
  end
  return false
end

return sides
