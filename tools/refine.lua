-- hooke refine SCENE.lua [name=value ...]: the same scene with half the cell, and how much its measures change.
-- A step is compared with half of it by `run --verify`, particle by particle; cells are a parameter of the script, and with other cells
-- a liquid has other particles. So measures are compared, at all frames: each has a sentence, and --within says how much is too much.
local argparse = require("argparse")
local case_process = require("common.run.case_process")
local command_line = require("common.run.command_line")
local parameters = require("common.run.parameters")

local inaccurate = 5 -- the exit code of `hooke run` for a result that is known to be inaccurate

local function complain(format, ...) return command_line.complain("refine", format:format(...)) end

local function parser()
  local p = argparse("hooke refine", "The same scene with half the cell, and how much its measures change.")
  p:argument("scene", "the scene's script, and its parameters as name=value"):args("+")
  p:option("--of", "the scene's parameter that is halved"):default("cell")
  p:option("--within", "the most that a measure may change, by its largest value; above it the exit code is 5")
    :convert(command_line.positive("--within"))
  p:option("--until", "end of the runs, s (the scene's)"):convert(command_line.positive("--until"))
  p:flag("--trust", "the scene may use plugins beside it")
  return p
end

-- The parameter with its value, which leaves o.params; or nil and what is wrong.
local function halved(o)
  local declared, why = hooke.explain(o.scene, o.params, { trust = o.trust })
  if not declared then return nil, why end
  local wanted, given = { { name = o.of } }, o.params[o.of]
  o.params[o.of] = nil
  local fine
  fine, why = parameters.complete(wanted, declared, o.params)
  if not fine then
    local remedy = why:find("; it has ", 1, true) and ": name the one that is halved, --of NAME" or ""
    return nil, why:gsub("^%-%-by: ", "--of: ") .. remedy
  end
  local p = wanted[1]
  p.value = tonumber(given or p.start)
  if not (p.value and p.value > 0) then
    return nil, ("--of: %s is %s, and only what is above 0 is halved"):format(p.name, given or p.start)
  end
  if p.value / 2 < p.low then
    return nil, ("--of: half of %s, %g, is below the least that the scene takes, %g: begin with %s=%g or more"):format(p.name,
      p.value / 2, p.low, p.name, 2 * p.low)
  end
  return p
end

-- ---- the runs ----

-- In a process of its own: the measures of all frames, and the summary.
local function follow(case)
  local scene, refused = hooke.load(case.scene, case.params, { ["until"] = case["until"], trust = case.trust })
  if not scene then return { failed = refused } end
  local fine, run = pcall(scene.run, scene, { to = 0 })
  local frames, k = {}, 0
  while fine do
    local now = run:summary()
    frames[#frames + 1] = { t = now.t, measures = now.measures }
    if now.t >= now["end"] * (1 - 1e-12) then break end
    k = k + 1
    fine, run = pcall(scene.run, scene, { to = math.min(k / now.fps, now["end"]) })
  end
  if not fine then return { failed = tostring(run) } end
  local last = run:summary()
  return { frames = frames, verdict = last.verdict, reason = last.reason, particles = last.particles, units = last.measure_units }
end

local function run_with(o, p, value)
  local params = { [p.name] = ("%.17g"):format(value) }
  for name, given in pairs(o.params) do params[name] = given end
  return case_process.run { scene = o.scene, params = params, ["until"] = o["until"], trust = o.trust, execute = follow }
end

-- ---- what is said ----

-- Of a measure: its values at the end, its largest, and where the two runs differ most; nil: one of them does not have it.
local function compare(name, whole, half)
  local found = { size = 0, change = 0 }
  for k, frame in ipairs(whole.frames) do
    local a, b = frame.measures[name], half.frames[k] and half.frames[k].measures[name]
    if a and b then
      found.first, found.last = a, b
      found.size = math.max(found.size, math.abs(a), math.abs(b))
      if math.abs(a - b) > found.change then found.change, found.t = math.abs(a - b), frame.t end
    end
  end
  return found.first and found or nil
end

local function names_of(whole)
  local list = {}
  for name in pairs(whole.frames[#whole.frames].measures) do list[#list + 1] = name end
  table.sort(list)
  return list
end

-- Returns the measure that changes most, by its largest value, and how much.
local function say(whole, half)
  local worst
  for _, name in ipairs(names_of(whole)) do
    local found = compare(name, whole, half)
    local unit = whole.units[name] and " " .. whole.units[name] or ""
    local change = found and found.size > 0 and found.change / found.size or found and 0
    if not found then
      print(("  %s is a measure of one of the two alone"):format(name))
    elseif change == 0 then
      print(("  %s: %.6g%s in both"):format(name, found.first, unit))
    else
      print(("  %s: %.6g%s, then %.6g%s at the end; the largest difference is %.2g %% of its largest value, at t = %g s"):format(name,
        found.first, unit, found.last, unit, 100 * change, found.t))
    end
    if change and (not worst or change > worst.change) then worst = { name = name, change = change } end
  end
  return worst
end

local o = command_line.parse("refine", parser())
if not o then return 1 end
local fine, why = command_line.take_scene("refine", o)
if not fine then return complain("%s", why) end
local p
p, why = halved(o)
if not p then return complain("%s", why) end

local runs = {}
for k, value in ipairs { p.value, p.value / 2 } do
  runs[k] = run_with(o, p, value)
  if runs[k].failed then
    complain("with %s = %g: %s", p.name, value, runs[k].failed)
    return 3
  end
end
local whole, half = runs[1], runs[2]
if #names_of(whole) == 0 then
  return complain("the scene has no measure that could be compared: scene:measure(name, function(state) ... end)")
end
print(("%s = %g (%d particles), then %g (%d):"):format(p.name, p.value, whole.particles, p.value / 2, half.particles))
local worst = say(whole, half)
for k, run in ipairs(runs) do
  if run.verdict ~= "ok" then
    print(("  the run with %s = %g is %s: %s"):format(p.name, p.value / k, run.verdict, run.reason))
  end
end
if o.within and not (worst and worst.change <= o.within) then
  print(worst and ("inaccurate: %s changes by %.2g %%, more than --within allows (%.2g %%): take a smaller %s"):format(worst.name,
    100 * worst.change, 100 * o.within, p.name) or "inaccurate: no measure is there in both runs, so nothing was compared")
  return inaccurate
end
return 0
