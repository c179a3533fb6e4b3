-- The sensitivity of a scene to its start state: the growth of random perturbations of two sizes until the end, with
-- several seeds. Rounding is a perturbation of 1e-16 of the scene's extent as well, so the growth sets a floor below
-- which methods cannot be distinguished. For a start at a buckling load this floor is high although two references
-- agree, since both preserve a symmetry that no real start has.
local sampled_run = require("common.bench.sampled_run")
local process = require("process")
local states = require("states")

local sensitivity = {}

sensitivity.rounding, sensitivity.rounding_single = 1e-16, 6e-8
sensitivity.sizes, sensitivity.seeds = { 1e-9, 1e-7 }, { 1, 2, 3 }

local function geometric_mean(list)
  local sum = 0
  for _, value in ipairs(list) do sum = sum + math.log(value) end
  return math.exp(sum / #list)
end

-- Compares a perturbed run with the unperturbed one: the growth at each frame, and that of the metric's difference at
-- the end.
local function growth_of(plain, perturbed, metric)
  local first = states.distance(plain.states[1], perturbed.states[1])
  if not first or first.x_rms == 0 then return nil end
  local d = sampled_run.compare(plain, perturbed)
  if not d then return nil end
  local list = {}
  for k, x in ipairs(d.x) do list[k] = x / first.x_rms end
  local whole = metric == "v" and d.v_rms or d.measure[metric] or d.x_rms
  return { list = list, last = list[#list], most = math.max(table.unpack(list, 1, math.min(#list, 200))),
    metric = whole / first.x_rms, start = first.x_rms }
end

-- Sets the floor. A result is rounded at least once, so the floor is not zero for a perturbation that decays.
function sensitivity.set_floor(found, growth)
  found.floor = math.max(growth, 1) * sensitivity.rounding * found.extent
  found.floor_single = math.max(growth, 1) * sensitivity.rounding_single * found.extent
end

-- The perturbed runs, in the order of their use: each size once, then the next seed.
local function cases_of(bench, case)
  local list = {}
  for _, seed in ipairs(sensitivity.seeds) do
    for _, size in ipairs(sensitivity.sizes) do
      local one = bench.case()
      one.integrator, one.dt, one.tol = case.integrator, case.dt, case.tol
      one.motion, one.keep, one.perturb, one.perturb_seed = true, true, size, seed
      list[#list + 1] = one
    end
  end
  return list
end

-- bench: as for reference.compute; plain: the unperturbed run { case, motion, time }, by a cheap method of sufficient
-- accuracy; seconds: the time available, but each size is run once in any case. Returns nil and the reason; or { growth
-- (at the end, the worst of the smaller size), sizes = { { size, growth, worst, count } }, seeds, extent (m), floor,
-- floor_single (m), by_frame (growth at each frame after the start) }
function sensitivity.measure(bench, plain, seconds)
  local begun, runs, at = process.processor_time(), {}, 0
  local cases = cases_of(bench, plain.case)
  local function next_case()
    at = at + 1
    if at > #sensitivity.sizes and process.processor_time() - begun + plain.time > seconds then return nil end
    local case = cases[at]
    if case then case.allowance = math.max(seconds, 4 * plain.time + 1) end
    return case
  end
  local squares, ended = 0, 0
  bench.run(next_case, function(one, result)
    local moved = result.states and not result.failed and { states = result.states, measures = result.motion.measures }
    ended = ended + (moved and 1 or 0)
    local growth = moved and growth_of(plain.motion, moved, bench.metric)
    if growth then
      squares = squares + (growth.start / one.perturb) ^ 2
      runs[#runs + 1] = { size = one.perturb, growth = growth }
    end
  end)
  local extent = math.sqrt(squares / math.max(#runs, 1)) -- RMS of a displacement of up to `size` in every direction
  local found = { sizes = {}, extent = extent, seeds = math.ceil(#runs / #sensitivity.sizes) }
  for _, size in ipairs(sensitivity.sizes) do
    local ends, worst = {}, nil
    for _, run in ipairs(runs) do
      if run.size == size then
        ends[#ends + 1] = math.max(run.growth.last, 1e-300)
        if not worst or run.growth.last > worst.last then worst = run.growth end
      end
    end
    if worst then
      found.sizes[#found.sizes + 1] = { size = size, growth = geometric_mean(ends), worst = worst.last, count = #ends }
      found.growth = found.growth or worst.last
      found.metric_growth = found.metric_growth or worst.metric
      found.by_frame = found.by_frame or worst.list
    end
  end
  if not found.growth then
    return nil, ended > 0 and "no particle is free to be displaced" or "no disturbed run came to the end"
  end
  sensitivity.set_floor(found, found.metric_growth)
  return found
end

return sensitivity
