-- The cost and the effect of each part of a scene (force, constraint, corrector, source), measured by runs without it.
--
-- Cost is time of the loop, on one thread: runs with and without the part alternate, and the median of their ratios
-- counts, with the median deviation from it as its spread. Without a stiff force an explicit method chooses a longer
-- step, so there are two costs: at the step of the whole scene and at the step that the scene without the part would
-- choose. The effect is the difference of the final state and the measures from those of the whole scene, at the step
-- of the whole scene, so that it is due to the part and not to the step. A chaotic scene changes with any perturbation:
-- runs of the whole scene with a start perturbed by 1e-10 of its extent measure this change, and where it exceeds a
-- thousandth of the extent, differences below the extent have no meaning.
local case_process = require("common.run.case_process")
local states = require("states")
local process = require("process")

local cost = { disturbance = 1e-10 }

local SEEDS = 2          -- perturbations; the larger effect counts
local CHANCE = 3         -- differences below this multiple of that effect are not significant
local CHAOS = 1e-3       -- relative to the extent
local PATIENCE = 20      -- a run without a part is ended after this multiple of the whole scene's time + seconds
local parts_of = { force = true, constraint = true, corrector = true, source = true }

-- ---- running ----

local function median(list)
  table.sort(list)
  local middle = #list // 2
  return #list % 2 == 1 and list[middle + 1] or (list[middle] + list[middle + 1]) / 2
end

local function keep_ends(_, list)
  list[2] = list[#list]
  for k = #list, 3, -1 do list[k] = nil end
end

-- The options of a case of the study; without an accuracy, which would check every run by a second one.
local function case_of(study, changes)
  local case = { scene = study.scene, params = study.params, integrator = study.integrator,
    ["until"] = study["until"], trust = study.trust, accuracy = 0 }
  for key, value in pairs(changes) do case[key] = value end
  return case
end

local function run_all(study, cases, jobs)
  local next = 0
  case_process.each(jobs, function()
    next = next + 1
    return cases[next]
  end, function(case, result)
    case.result = result
    study.done = study.done + 1
  end, study.tick and function() study.tick(study.done) end)
end

local function with_states(study, changes)
  changes.frames, changes.keep, changes.finish = true, true, keep_ends
  return case_of(study, changes)
end

-- ---- the effect of a part ----

-- The longest side of the bounding box of the particles in all packed states, m.
local function extent_of(packed)
  local low, high = { math.huge, math.huge, math.huge }, { -math.huge, -math.huge, -math.huge }
  for _, state in ipairs(packed) do
    local n = math.tointeger((string.unpack("<d", state)))
    for k = 0, 3 * n - 1 do
      local x, c = string.unpack("<d", state, 1 + 8 * (2 + n + k)), k % 3 + 1
      low[c], high[c] = math.min(low[c], x), math.max(high[c], x)
    end
  end
  return math.max(0, high[1] - low[1], high[2] - low[2], high[3] - low[3])
end

-- The difference of the final states and of the measures of two results.
local function difference(a, b)
  local apart, why = states.distance(a.states[2], b.states[2])
  local found = { x = apart and apart.x_rms, why = why, measures = {} }
  for name, value in pairs(a.measures) do
    local other = b.measures[name]
    if other then
      found.measures[name] = { with = value, without = other, change = other - value,
        relative = value ~= 0 and (other - value) / math.abs(value) or nil }
    end
  end
  return found
end

-- The effect of perturbations on the whole scene: x, m, and the change of every measure.
local function chance_of(whole, perturbed)
  local most = { x = 0, measures = {} }
  for _, case in ipairs(perturbed) do
    if case.result.failed then return nil, case.result.failed end
    local found = difference(whole, case.result)
    if not found.x then return nil, found.why end
    most.x = math.max(most.x, found.x)
    for name, m in pairs(found.measures) do
      most.measures[name] = math.max(most.measures[name] or 0, math.abs(m.change))
    end
  end
  return most
end

-- The largest distance of final states, m, that perturbations explain; nil: not known.
local function significance_limit(study)
  local chance = study.chance
  return chance and math.max(CHANCE * chance.x, study.chaotic and study.extent or 0)
end

local function weigh(study, part)
  local limit, chance = significance_limit(study), study.chance
  local found = difference(study.whole, part.same.result)
  part.x, part.why, part.measures = found.x, found.why, found.measures
  part.x_relative = part.x and study.extent > 0 and part.x / study.extent or nil
  part.by_chance = part.x and limit and part.x <= limit or false
  for name, m in pairs(part.measures) do
    m.chance = chance and chance.measures[name]
    m.by_chance = m.chance and (math.abs(m.change) <= CHANCE * m.chance or study.chaotic and part.by_chance) or false
  end
end

-- ---- the cost of a part ----

local function timed(case)
  local bare = {}
  for key, value in pairs(case) do bare[key] = value end
  bare.frames, bare.keep, bare.finish, bare.result = nil, nil, nil, nil
  return bare
end

-- One round: the variants of each part are run right after a run of the whole scene.
local function round_of(study, whole_case, variants)
  local list, pairs_of = {}, {}
  for _, list_of in ipairs(variants) do
    local whole = timed(whole_case)
    list[#list + 1] = whole
    for _, variant in ipairs(list_of) do
      local case = timed(variant.case)
      list[#list + 1] = case
      pairs_of[#pairs_of + 1] = { variant = variant, whole = whole, case = case }
    end
  end
  run_all(study, list, 1)
  return pairs_of
end

local function note_round(study, pairs_of)
  for _, pair in ipairs(pairs_of) do
    local with, without = pair.whole.result, pair.case.result
    if not with.failed and not without.failed then
      table.insert(study.seconds, with.step_wall_s)
      table.insert(pair.variant.ratios, without.step_wall_s / with.step_wall_s)
    end
  end
end

local function spread(list, middle)
  local off = {}
  for k, value in ipairs(list) do off[k] = math.abs(value - middle) end
  return median(off)
end

local function figures(variant)
  local r = variant.case.result
  local f = { result = r, dt = r.steps and r.steps > 0 and r.t / r.steps or nil, steps = r.steps,
    force_evaluations = r.force_evaluations, verdict = r.verdict, reason = r.reason }
  if #variant.ratios > 0 then
    local ratio = median(variant.ratios)
    f.saved, f.spread, f.repeats = 1 - ratio, spread(variant.ratios, ratio), #variant.ratios
  end
  return f
end

local function time_all(study, whole_case, parts)
  local variants = {}
  for _, part in ipairs(parts) do
    local list = {}
    for _, key in ipairs { "same", "own" } do
      local case = part[key .. "_case"]
      if not case.result.failed and (key == "same" or case ~= part.same_case) then
        list[#list + 1] = { key = key, part = part, case = case, ratios = {} }
      end
    end
    if #list > 0 then variants[#variants + 1] = list end
  end
  study.total = study.done
  for _, list in ipairs(variants) do study.total = study.total + study.repeats * (1 + #list) end
  for _ = 1, study.repeats do note_round(study, round_of(study, whole_case, variants)) end
  for _, list in ipairs(variants) do
    for _, variant in ipairs(list) do variant.part[variant.key] = figures(variant) end
  end
end

-- ---- the study ----

-- An error message without a place in this file.
local function cause(message)
  local own = hooke.folder:gsub("%p", "%%%0") .. "[^:]*:%d+: "
  return (tostring(message):gsub("^" .. own, ""))
end

-- Reads the parts of the scene and the accuracy that it asks for.
local function scene_parts(study)
  local scene, refused = hooke.load(study.scene, study.params,
    { integrator = study.integrator, ["until"] = study["until"], threads = 1, trust = study.trust })
  if not scene then return nil, refused end
  local fine, run = pcall(scene.run, scene, { to = 0 })
  if not fine then return nil, cause(run) end
  return run:summary()
end

local function parts_in(summary)
  local parts = {}
  for _, p in ipairs(summary.plugins) do
    if parts_of[p.kind] then parts[#parts + 1] = { kind = p.kind, name = p.name, label = p.label } end
  end
  return parts
end

local function whole_runs(study)
  local whole, perturbed = with_states(study, {}), {}
  local cases = { whole }
  for seed = 1, SEEDS do
    perturbed[seed] = with_states(study, { perturb = cost.disturbance, perturb_seed = seed })
    cases[seed + 1] = perturbed[seed]
  end
  study.total = #cases
  run_all(study, cases, process.processors())
  return whole, perturbed
end

-- Runs without each part, at the step that the run chooses itself.
local function own_runs(study, whole, parts)
  local cases = {}
  study.patience = PATIENCE * whole.process_s + 10
  for k, part in ipairs(parts) do
    part.own_case = with_states(study, { without = { part.label }, timeout = study.patience })
    cases[k] = part.own_case
  end
  study.total = study.total + #cases
  run_all(study, cases, process.processors())
end

-- Runs without each part at the step of the whole scene; needed only where the step is chosen from the stable limit,
-- and so differs.
local function same_runs(study, whole, parts)
  local again = {}
  for _, part in ipairs(parts) do
    part.same_case = part.own_case
    if whole.dt_limit and part.own_case.result.steps ~= whole.steps then
      part.same_case = with_states(study, { without = { part.label }, timeout = study.patience,
        dt = whole.t / whole.steps * (1 + 1e-9) })
      again[#again + 1] = part.same_case
    end
  end
  study.total = study.total + #again
  run_all(study, again, process.processors())
end

-- The order of parts: largest effect per time first; before all others those that save no measurable time.
local function value(part)
  local c = part.own
  return part.x and c and c.saved and c.saved > 2 * c.spread and part.x / c.saved or math.huge
end

local function by_value(a, b)
  local u, v = value(a), value(b)
  if u ~= v then return u > v end
  local x, y = a.x or math.huge, b.x or math.huge
  return x > y or (x == y and a.label < b.label)
end

-- study: scene, params, integrator and until (nil: the scene's), repeats (nil: 5, of short runs up to 25), tick(done,
-- total) or nil. The result has
--   accuracy (m, or nil), extent (m), whole (the run's summary), seconds (s, median), chance {x, measures} or nil and
--   chance_why, chaotic, parts: a list of {kind, name, label, failed | same, own, x, why, x_relative, by_chance,
--   measures}.
-- same and own: {dt, steps, force_evaluations, saved and spread (relative to the run's time), repeats, verdict,
-- reason}. Or nil and the reason.
function cost.study(study)
  local summary, refused = scene_parts(study)
  if not summary then return nil, refused end
  study.accuracy, study.done, study.seconds = summary.accuracy, 0, {}
  local tick = study.tick
  if tick then study.tick = function(done) tick(done, study.total) end end
  local parts = parts_in(summary)
  local whole_case, perturbed = whole_runs(study)
  local whole = whole_case.result
  if whole.failed then return nil, "the whole scene: " .. whole.failed end
  study.whole, study.extent = whole, extent_of(whole.states)
  study.chance, study.chance_why = chance_of(whole, perturbed)
  study.chaotic = study.chance and study.chance.x > CHAOS * study.extent or false
  study.repeats = study.repeats or math.max(5, math.min(25, math.ceil(0.2 / whole.step_wall_s)))
  own_runs(study, whole, parts)
  same_runs(study, whole, parts)
  time_all(study, whole_case, parts)
  for _, part in ipairs(parts) do
    if part.own_case == part.same_case then part.own = part.same end
    local same, own = part.same_case.result.failed, part.own_case.result.failed
    part.same_failed, part.own_failed = same and cause(same), own and cause(own)
    part.failed = part.same_failed and part.own_failed
    if part.same and not part.same_failed then weigh(study, part) end
  end
  table.sort(parts, by_value)
  study.seconds = #study.seconds > 0 and median(study.seconds) or whole.step_wall_s
  study.parts = parts
  return study
end

return cost
