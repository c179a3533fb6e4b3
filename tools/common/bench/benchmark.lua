-- A bench from the reference to the ranking, without printing: tools/bench.lua prints the results and tools/auto.lua
-- uses them for its choice. The phases of a bench:
--   reference     two methods refined until they agree; where they cannot, up to the horizon until which they do
--   conditioning  the growth of perturbations, and the floor of errors that it sets
--   ladders       runs of every method from cheap to accurate, one process at a time, with errors against the reference
--   settling      runs of those that may be the best at the target, with settings that just reach it
--   repeats       the settings that matter, timed again in turns
local sensitivity = require("common.bench.sensitivity")
local refinement = require("common.bench.refinement")
local methods = require("common.bench.methods")
local sampled_run = require("common.bench.sampled_run")
local process = require("process")
local journal = require("common.bench.journal")
local reference = require("common.bench.reference")
local report = require("common.bench.report")
local states = require("states")
local case_process = require("common.run.case_process")

local benchmark = {}

-- Fractions of the time; repeats get the rest.
local part = { reference = 0.3, conditioning = 0.1, refinement = 0.4, settling = 0.1 }
local most_state_bytes = 64e6 -- size of the stored frames of the reference
local energy_rounding = 2e-14 -- relative to the largest kinetic energy: a hundred rounding errors
local exact_rounding = 2e-15  -- relative to the size of the motion: rounding errors of the exact solution's formula

case_process.execute = sampled_run.execute

-- ---- running cases ----

local function key_of(case)
  local told = {}
  for _, name in ipairs { "integrator", "dt", "tol", "until", "every", "perturb", "perturb_seed", "motion", "turn",
    "threads", "repeats" } do told[name] = case[name] end
  told.compared, told.varied = case.against and true or nil, case.varied
  return journal.canonical(told)
end

local function is_usable(result, case)
  return result and (result.verdict ~= "timeout" or (result.patience or 0) >= 0.9 * (case.allowance or math.huge))
end

-- Runs the cases that next() returns (or a list), uses stored results, and passes each result to done(case, result).
local function run_all(self, source, done, jobs)
  local next_case = source
  if type(source) == "table" then
    local at = 0
    next_case = function()
      at = at + 1
      return source[at]
    end
  end
  local function fresh()
    while true do
      local case = next_case()
      if not case then return nil end
      local known = self.record and self.record:get(key_of(case))
      if not is_usable(known, case) then return case end
      self.taken = (self.taken or 0) + 1
      done(case, known)
    end
  end
  case_process.each(jobs or self.jobs, fresh, function(case, result)
    if result.verdict == "timeout" then result.patience = case.allowance end
    if self.record then self.record:put(key_of(case), result) end
    if jobs == 1 then
      for _, time in ipairs(result.times or { result.step_s }) do
        self.timed = self.timed + time + (result.start_wall_s or 0)
      end
      if result.verdict == "timeout" then self.timed = self.timed + case.allowance end
    end
    if self.each then self.each(case, result) end
    done(case, result)
  end, self.tick)
end

-- ---- the scene ----

local function is_at_rest(motion)
  for _, state in ipairs(motion.states) do
    local d = states.distance(motion.states[1], state)
    if not d or d.x_rms > 0 or d.v_rms > 0 then return false end
  end
  return true
end

-- Whether the scene has the metric, before anything is run. names: its measures.
local function check_metric(metric, names)
  if metric == "x" or metric == "v" or metric == "energy" then return true end
  for _, name in ipairs(names) do
    if name == metric then return true end
  end
  local near = hooke.nearest(metric, names)
  return nil, ("--metric %s: the scene has no such measure%s; x, v, energy%s can be chosen"):format(metric,
    near and (", did you mean '%s'?"):format(near) or "", #names > 0 and " and " .. table.concat(names, ", ") or "")
end

local function check_motion(self, motion)
  local names = self.explained.measures
  if (self.metric == "x" or self.metric == "v") and is_at_rest(motion) then
    return nil, ("nothing moves in this scene, so positions say nothing of a method: choose a measure with --metric%s")
      :format(#names > 0 and " (" .. table.concat(names, ", ") .. ")" or "; the scene has none")
  end
  return true
end

-- Whether the scene starts with each value of --vary: an unknown parameter or a value out of its range is told here, and not by
-- each of a hundred runs.
local function check_varied(list, options)
  local seen = {}
  for _, method in ipairs(list) do
    local name, value = next(method.params)
    if not seen[value] then
      seen[value] = true
      local params = {}
      for key, own in pairs(options.params or {}) do params[key] = own end
      params[name] = value
      local explained, why = case_process.explain(options.scene, params, { trust = options.trust })
      if not explained then return nil, ("--vary %s=%s: %s"):format(name, value, why) end
    end
  end
  return true
end

-- options: scene, params, until_, threads, trust, metric, target, finest, budget, jobs, integrators (text), vary (text),
-- margin (of errors to the reference's own), only_best (methods that are slower than the best at the target are not
-- refined further, a reference that is as good as its margin asks for will do, and no perturbation is followed). In the
-- returned bench the caller may set `record` (tools/common/bench/journal.lua), each(case, result) and tick().
function benchmark.new(options)
  local explained, why = case_process.explain(options.scene, options.params, { trust = options.trust })
  if not explained then return nil, why end
  local catalogue = hooke.catalogue()
  local list = methods.all(catalogue, explained.steps)
  if options.integrators then
    list, why = methods.chosen(catalogue, explained.steps, options.integrators)
    if not list then return nil, why end
  end
  if options.vary then
    list, why = methods.varied(list, options.vary)
    if not list then return nil, why end
    local fine
    fine, why = check_varied(list, options)
    if not fine then return nil, why end
  end
  local known, unknown = check_metric(options.metric or "x", explained.measures)
  if not known then return nil, unknown end
  local self = { options = options, explained = explained, methods = list, step = {}, fps = explained.fps, timed = 0,
    jobs = options.jobs or process.processors(), metric = options.metric or "x",
    brief = options.only_best, margin = options.margin or reference.margin,
    limit = options.until_ or explained.duration }
  for _, s in ipairs(explained.steps) do self.step[s.name] = s end
  self.stages, self.implicit = {}, {}
  for _, plugin in ipairs(catalogue) do
    if plugin.kind == "integrator" then
      self.stages[plugin.name], self.implicit[plugin.name] = plugin.stages, plugin.implicit
    end
  end
  local frames = math.ceil(self.limit * self.fps) + 1
  self.every = math.max(1, math.ceil(frames * explained.particles * 56 / most_state_bytes))
  -- varied: { name = value }, parameters of the scene beside those of the options, or nil
  function self.case(varied)
    local params = {}
    for name, value in pairs(options.params or {}) do params[name] = value end
    for name, value in pairs(varied or {}) do params[name] = value end
    return { scene = options.scene, params = params, varied = varied, ["until"] = self.limit,
      threads = options.threads or 1, every = self.every, trust = options.trust }
  end
  function self.run(cases, done, jobs) run_all(self, cases, done, jobs) end
  return self
end

-- ---- the phases ----

local function shorten(motion, frames)
  local cut = { states = table.move(motion.states, 1, frames, 1, {}), t = table.move(motion.t, 1, frames, 1, {}),
    exact = table.move(motion.exact or {}, 1, frames, 1, {}), measures = {} }
  for name, list in pairs(motion.measures) do cut.measures[name] = table.move(list, 1, frames, 1, {}) end
  return cut
end

local function size_of(difference, metric)
  return metric == "v" and difference.v_rms or difference.measure[metric] or difference.x_rms
end

-- The reference up to `frames` frames after the start.
local function cut(self, found, frames)
  found.motion, found.other = shorten(found.motion, frames + 1), shorten(found.other, frames + 1)
  found.method = { case = found.method.case, time = found.method.time,
    motion = shorten(found.method.motion, frames + 1) }
  found.error = sampled_run.compare(found.motion, found.other)
  found.size = size_of(found.error, self.metric)
  self.limit = found.motion.t[frames + 1]
end

local function scale_of(motion)
  local far = 0
  for _, state in ipairs(motion.states) do
    local d = states.distance(motion.states[1], state)
    if d then far = math.max(far, d.x_rms) end
  end
  return far
end

local function exact_of(motion)
  if #motion.exact < #motion.t then return nil end
  local sum = 0
  for k = 2, #motion.exact do sum = sum + motion.exact[k] ^ 2 end
  return math.sqrt(sum / math.max(#motion.exact - 1, 1))
end

-- s of the processor. Of a bench two runs go on at once, each with the time; a choice counts all that it takes.
local function time_for_reference(self)
  local budget = self.options.budget
  if self.brief then return (part.reference + part.conditioning) * budget end
  return math.min(self.jobs, 2) * part.reference * budget
end

-- Finds the reference. Where the two methods do not agree to a hundredth of the target until the end, the bench is
-- shortened to the time until which they do.
local function find_reference(self)
  local aim = self.options.finest / self.margin
  local found, why = reference.compute(self, aim, time_for_reference(self))
  if not found then return nil, why end
  local fine
  fine, why = check_motion(self, found.motion)
  if not fine then return nil, why end
  self.scale, self.exact = scale_of(found.motion), exact_of(found.motion)
  self.doubted = self.exact and self.exact > self.margin * found.error.x_rms + exact_rounding * self.scale
  if found.size * self.margin > self.options.target and not (self.exact and self.metric == "x") then
    self.cut_from = { t = self.limit, size = found.size, late = found.late }
    if found.frames < 1 then
      return nil, ("%s differ from the first frame on, by %.2g over all: an error cannot be told in this scene; "
        .. "a larger --target or --budget may help"):format(found.description, found.size)
    end
    cut(self, found, found.frames)
    self.horizon = self.limit
  end
  self.reference = found
  return true
end

-- Perturbations that have grown to the size of the motion no longer measure the growth.
local function saturated_at(self, found)
  for k, growth in ipairs(found.by_frame) do
    if growth * sensitivity.sizes[1] * found.extent > 0.03 * self.scale then return k end
  end
end

local function condition(self)
  local found, why = sensitivity.measure(self, self.reference.method, part.conditioning * self.options.budget)
  if not found then
    self.conditioning_failed = why
    return
  end
  local k = saturated_at(self, found)
  if k and k > 1 then
    self.cut_from = self.cut_from or { t = self.limit, size = self.reference.size }
    cut(self, self.reference, k - 1)
    self.horizon = self.limit
    found.growth = found.by_frame[k - 1]
    sensitivity.set_floor(found, found.growth)
  end
  self.conditioning = found
end

-- The smallest errors that can be resolved, by column: a hundred times the reference's own error; for positions of a
-- scene with an exact solution, some rounding errors; and for the metric the floor by the conditioning.
local function supports_of(self)
  local error, floor = self.reference.error, self.conditioning and self.conditioning.floor or 0
  local supports, metric = { measure = {} }, self.metric
  for _, name in ipairs { "x_rms", "x_max", "v_rms", "v_max" } do supports[name] = self.margin * error[name] end
  for name, value in pairs(error.measure) do supports.measure[name] = self.margin * value end
  if self.exact then
    supports.x_rms = exact_rounding * self.scale
    if self.explained.particles == 1 then supports.x_max = supports.x_rms end
  end
  if metric == "x" or metric == "v" then
    for _, name in ipairs { "_rms", "_max" } do supports[metric .. name] = math.max(supports[metric .. name], floor) end
  elseif metric ~= "energy" then
    supports.measure[metric] = math.max(supports.measure[metric], floor)
  end
  return supports
end

local function goal_of(self)
  local supports, o = supports_of(self), self.options
  local metric = self.metric
  local support = metric == "energy" and energy_rounding or supports[metric .. "_rms"] or supports.measure[metric]
  local unit = metric == "x" and " m" or metric == "v" and " m/s" or ""
  local word = metric == "energy" and "energy drift" or metric == "x" and "error" or "error of " .. metric
  return { metric = metric, fps = self.fps, motion = self.reference.motion, finest = o.finest, target = o.target,
    only_best = o.only_best, support = support, supports = supports, seconds = self.limit, unit = unit, word = word,
    scale = metric == "x" and self.scale > 0 and self.scale or math.huge }
end

local near_best = 1.5 -- relative to the cheapest at the target: where only the best is looked for, others are not timed again

local function contenders(ranking)
  local rows = {}
  for _, entry in ipairs(ranking) do
    if entry.reached and entry.row.wall_s <= near_best * ranking[1].row.wall_s then rows[#rows + 1] = entry.row end
  end
  return rows
end

local function rows_that_matter(self, ranking)
  if self.goal.only_best then return contenders(ranking) end
  local rows, seen = {}, {}
  for _, entry in ipairs(ranking) do
    if entry.row then
      rows[#rows + 1] = entry.row
      seen[entry.row] = true
    end
  end
  for _, row in ipairs(report.front(self.methods, self.goal)) do
    if not seen[row] then rows[#rows + 1] = row end
  end
  return rows
end

local function rank(self)
  self.front = report.front(self.methods, self.goal)
  self.ranking = report.ranking(self.methods, self.goal)
end

-- say(text) is called with messages. Returns nil and the reason, or true and sets self.ranking, self.recommended, ...
function benchmark.measure(self, say)
  local budget = self.options.budget
  say("reference")
  local begun = process.processor_time()
  local fine, why = find_reference(self)
  if not fine then return nil, why end
  if not self.brief then
    say("conditioning")
    condition(self)
  end
  self.reference_s, self.reference.other, self.reference.method = process.processor_time() - begun, nil, nil
  self.goal = goal_of(self)
  collectgarbage() -- frees the states of finished runs, which every process of a timed run would otherwise contain
  say("ladders")
  local ladder_begun = process.processor_time()
  refinement.run(self.methods, self, self.goal, part.refinement * budget * (self.brief and 1.5 or 1))
  refinement.settle(self.methods, self, self.goal, part.settling * budget)
  for _, method in ipairs(self.methods) do method.observed = report.order(method, self.goal) end
  rank(self)
  say("repeats")
  local left = budget - (process.processor_time() - begun)
  refinement.repeat_rows(rows_that_matter(self, self.ranking), self, 3, math.min(left, 0.5 * budget))
  rank(self)
  self.own_s = process.processor_time() - ladder_begun - self.timed
  self.recommended, self.recommendation = report.recommend(self.ranking, self.goal)
  return true
end

return benchmark
