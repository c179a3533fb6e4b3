-- The largest stable step on a scene, measured by runs, and compared with the estimate that dt = auto uses.
--
-- Two runs with the same steps have start positions that differ by 1e-8 of the scene's extent. Their distance, RMS over
-- the particles, keeps its size while the step is stable, since every mode oscillates; above the limit it grows by a
-- factor per step. A step counts as unstable when a run diverges or the largest distance of the last quarter of 600
-- steps is four times that of the second quarter. Growth in the same time at a half, a third and a quarter of the step is
-- that of the motion itself (a cloth that buckles, a string that cracks like a whip) and does not count. Of a chaotic
-- motion it is known to some orders of magnitude only, as long steps lead another way than short ones. Where the motion
-- spreads by itself, and a step more, 16 times as many steps tell: what is unstable then diverges, or has gained more energy
-- than the motion ever had, while chaos goes on with what it has. The search starts from the estimate, and its bracket is
-- halved to 2 %.
--
-- A mode that grows by less than 1 % per step is not detected in 600 steps: where the estimate seems too small, 16
-- times as many steps are tried with the step that it should have allowed, and the search continues with this number if
-- the distance grows. This suffices for all methods except those that are stable only with damping and grow without it
-- by about (h w)^4/8 per step: runs do not detect the beginning of this growth, so a much smaller estimate is not an
-- error ("slow").
--
-- Some methods grow in a narrow band of h w and are stable again beyond it. The estimate ends where the band begins, since
-- a mode may lie in it at any time; a scene of which none does can go on, and that is no error either ("banded").
--
-- A motion may stiffen the scene: the smallest estimate of the run is compared.
local json = require("cjson").new()
local plot = require("common.run.plot")
local process = require("process")
local stability_region = require("common.stability.stability_region")
local states = require("states")
local case_process = require("common.run.case_process")

json.encode_invalid_numbers(true)
json.decode_invalid_numbers(true)

local largest_step = {}

local frames, apart, growth_limit, precision = 600, 1e-8, 4, 0.02
local finer = { 2, 3, 4 } -- steps for one, where the motion's own growth is looked for
local strides = { 1, 16 } -- steps per frame
largest_step.least = 0.8 -- smallest allowed ratio of the estimate to the measured limit

-- ---- one step, stable or not ----

local function case_of(task, step, stride, perturb)
  return { scene = task.scene, params = task.params, integrator = task.integrator, dt = step, fps = 1 / (stride * step),
    duration = frames * stride * step, accuracy = 0, frames = true, perturb = perturb }
end

local function largest(a, b, from, to)
  local most = 0
  for k = from, to do most = math.max(most, states.distance(a[k], b[k]).x_rms) end
  return most
end

-- The growth of the distance, and the smallest estimate of the run. math.huge: a run diverged. nil and the reason: it
-- could not start.
local function growth_of(task, step, stride)
  local first, a = case_process.execute(case_of(task, step, stride, 0))
  if first.fits == false then return nil, first.failed end
  local second, b = case_process.execute(case_of(task, step, stride, apart))
  if first.failed or second.failed or #a < frames or #b < frames then return math.huge end
  local quarter = frames // 4
  return largest(a, b, 3 * quarter, frames) / largest(a, b, quarter, 2 * quarter), first.dt_limit
end

-- Whether a run diverges, or gains more energy than the motion has.
local function gains(task, step, stride)
  local run, list = case_process.execute(case_of(task, step, stride, 0))
  local drift = run.energy and run.energy.drift
  return run.failed ~= nil or #list < frames or not (drift and drift < 1)
end

-- Whether a step is stable, and the smallest estimate of the run; or nil and the reason why it cannot be determined.
local function stable(task, step, stride)
  local growth, estimate = growth_of(task, step, stride)
  if not growth then return nil, estimate end
  if growth <= growth_limit then return true, estimate end
  if growth == math.huge then return false end
  local own = 1
  for _, parts in ipairs(finer) do own = math.max(own, growth_of(task, step / parts, parts * stride)) end
  if growth <= own * growth_limit then return true, estimate end
  return own > growth_limit and not gains(task, step, strides[2]), estimate
end

-- ---- the limit ----

-- Finds a stable and an unstable step from a start value in steps of 12 %, and bisects the interval between them.
local function search(task, step, stride)
  local found = { low = 0, high = math.huge, stride = stride }
  while found.low == 0 or found.high > found.low * (1 + precision) do
    local fine, estimate = stable(task, step, stride)
    if fine == nil then return nil, estimate end
    if fine then found.low, found.later = step, estimate else found.high = step end
    if found.low > 10 * task.estimate or found.high < 0.1 * task.estimate then return found end
    step = found.high == math.huge and step * 1.12 or found.low == 0 and step / 1.12 or math.sqrt(found.low * found.high)
  end
  return found
end

-- The bracket { low =, high = } of the largest stable step: low is stable, high is not. Or nil and the reason.
local function bracket(task)
  local found, why = search(task, task.estimate, strides[1])
  for k = 2, #strides do
    if not found or task.estimate >= largest_step.least * found.low then return found, why end
    local longer = task.estimate / largest_step.least
    if not stable(task, longer, strides[k]) then found, why = search(task, longer, strides[k]) end
  end
  return found, why
end

-- ---- the tasks ----

local function copy(t, name, value)
  local c = {}
  for k, v in pairs(t) do c[k] = v end
  if name then c[name] = value end
  return c
end

local usual = { { "k", { 1e2, 1e5 } }, { "damping", { 0, 0.1, 1 } }, { "ratio", { 1e-2, 1e4 } },
  { "N", { 16 } } }

-- "k=1e2,1e4" -> { "k", { "1e2", "1e4" } }; or nil and the reason.
function largest_step.ladder(text)
  local name, values = text:match("^([%a_][%w_]*)=(.+)$")
  local list = {}
  for value in (values or ""):gmatch("[^,]+") do list[#list + 1] = value end
  if #list == 0 then return nil, ("--over: '%s' is not NAME=VALUE,VALUE,..."):format(text) end
  return { name, list }
end

-- The usual lists of values, for those parameters that the scene has.
function largest_step.usual(path, given)
  local list = {}
  for _, ladder in ipairs(usual) do
    if given[ladder[1]] == nil and case_process.explain(path, copy(given, ladder[1], ladder[2][1])) then list[#list + 1] = ladder end
  end
  return list
end

-- Whether a method needs damping to be stable at small steps.
local function needs_damping(plugin)
  local stated = stability_region.stated(plugin)
  return stated ~= nil and stated(0.3, 0) > 1 + 1e-9
end

-- Whether a method grows somewhere in 1 <= h w <= most without damping, and no longer at most. The spacing is a third of the
-- narrowest band that is known, as in core/numerics/stability/largest_step.c.
local function banded(plugin, most)
  local stated = stability_region.stated(plugin)
  if not stated or stated(most, 0) > 1 + 1e-6 then return false end
  local hw = 1
  while hw < most do
    if stated(hw, 0) > 1 + 1e-6 then return true end
    hw = hw * 1.0005
  end
  return false
end

-- The scene as given, and with every value of every list in turn: tasks with the estimate of each integrator. Those
-- without a useful step are omitted. Or nil and the reason.
function largest_step.tasks(path, given, ladders, plugins)
  local variants, tasks, wanted = { { params = given, name = "", value = "" } }, {}, {}
  for _, plugin in ipairs(plugins) do
    wanted[plugin.name] = not plugin.implicit and not plugin.adaptive and plugin or nil
  end
  for _, ladder in ipairs(ladders) do
    for _, value in ipairs(ladder[2]) do
      variants[#variants + 1] = { params = copy(given, ladder[1], value), name = ladder[1], value = value }
    end
  end
  for _, variant in ipairs(variants) do
    local e, why = case_process.explain(path, variant.params)
    if not e then return nil, why end
    for _, step in ipairs(e.steps) do
      if wanted[step.name] and step.limit > 0 and step.limit < math.huge then
        tasks[#tasks + 1] = { scene = path, params = variant.params, name = variant.name, value = variant.value,
          integrator = step.name, estimate = step.limit, suggestion = step.suggestion, w = e.spectrum.w_max,
          g = e.spectrum.g_max, particles = e.particles, slow = needs_damping(wanted[step.name]), plugin = wanted[step.name] }
      end
    end
  end
  if #tasks == 0 then return nil, "no integrator that was asked for has a stable step of its own to measure on this scene" end
  return tasks
end

-- ---- measuring all tasks ----

local function take(task, text)
  local fine, found = pcall(json.decode, text)
  if not fine then found = { why = "the process that measured it crashed" } end
  for _, key in ipairs { "low", "high", "stride", "later", "why" } do task[key] = found[key] end
  if not task.low then return end
  task.counts = math.min(task.estimate, task.later or math.huge)
  task.above = task.counts >= task.high
  local short = task.counts < largest_step.least * task.low
  task.banded = short and not task.slow and banded(task.plugin, task.w * task.low)
  task.below = short and not task.slow and not task.banded
end

local function work(task, fd)
  local fine, found, why = pcall(bracket, task)
  process.write(fd, json.encode(fine and found or { why = tostring(fine and why or found) }))
  process.exit(0)
end

-- Measures the tasks, `jobs` at a time: sets low and high (s) or why, and above and below, which mark an error of the
-- estimate.
function largest_step.run(tasks, jobs, done, tick)
  local running, count, next = {}, 0, 1
  while next <= #tasks or count > 0 do
    while count < jobs and tasks[next] do
      local task, pid, fd = tasks[next], process.fork()
      if pid == 0 then
        hooke.confine(task.scene)
        work(task, fd)
      end
      running[fd], count, next = { task = task, pid = pid, text = "" }, count + 1, next + 1
    end
    local fds = {}
    for fd in pairs(running) do fds[#fds + 1] = fd end
    for fd in pairs(process.ready(fds, 0.1)) do
      local job, text = running[fd], process.read(fd)
      job.text = job.text .. text
      if text == "" then
        process.close(fd)
        process.wait(job.pid)
        running[fd], count = nil, count - 1
        take(job.task, job.text)
        done(job.task)
      end
    end
    tick()
  end
end

-- ---- the report ----

largest_step.columns = { "integrator", "parameter", "value", "estimate", "estimate_later", "dt_auto", "limit_low", "limit_high",
  "ratio", "above", "below", "w_max", "g_max", "particles", "steps", "reason" }

function largest_step.row(task)
  return { integrator = task.integrator, parameter = task.name, value = task.value, estimate = task.estimate,
    estimate_later = task.later, dt_auto = task.suggestion, limit_low = task.low, limit_high = task.high,
    ratio = task.low and task.counts / task.low, above = task.above, below = task.below, w_max = task.w, g_max = task.g,
    particles = task.particles, steps = task.stride and task.stride * frames, reason = task.why }
end

local function variant_of(task)
  return task.name ~= "" and ("%s = %s"):format(task.name, task.value) or "as given"
end

local function cell(task)
  if not task then return "-" end
  if not task.low then return "?" end
  local mark = task.above and "!" or task.below and "<" or task.banded and "|" or task.slow and "~" or ""
  return ("%.2f%s"):format(task.counts / task.low, mark)
end

-- Variants by integrators: the estimate over the measured limit.
function largest_step.table(tasks)
  local names, order, at = {}, {}, {}
  for _, task in ipairs(tasks) do
    local variant = variant_of(task)
    if not at[variant] then
      at[variant] = {}
      order[#order + 1] = variant
    end
    if not names[task.integrator] then
      names[#names + 1] = task.integrator
      names[task.integrator] = true
    end
    at[variant][task.integrator] = task
  end
  local head = { (" "):rep(18) }
  for _, name in ipairs(names) do head[#head + 1] = (" %" .. math.max(6, #name) .. "s"):format(name) end
  local lines = { "estimate of the largest stable step over the measured limit\n", table.concat(head) }
  for _, variant in ipairs(order) do
    local line = { ("%-18s"):format(variant) }
    for _, name in ipairs(names) do
      line[#line + 1] = (" %" .. math.max(6, #name) .. "s"):format(cell(at[variant][name]))
    end
    lines[#lines + 1] = table.concat(line)
  end
  lines[#lines + 1] = ("\n!: above the limit, which must not be   <: below %g of it   ?: not measured   -: no step of use\n"
    .. "~: stable by damping alone; beyond the limit it grows too slowly to be measured sharply\n"
    .. "|: the method grows in a narrow band of frequencies, in which no mode happened to lie")
    :format(largest_step.least)
  return table.concat(lines, "\n")
end

-- The errors found, one line each.
function largest_step.wrong(tasks)
  local list = {}
  for _, task in ipairs(tasks) do
    local what = ("%s, %s"):format(task.integrator, variant_of(task))
    if task.why then list[#list + 1] = ("%s: not measured: %s"):format(what, task.why) end
    if task.above or task.below then
      list[#list + 1] = ("%s: the estimate %.4g s is %s; measured: stable at %.4g s, not at %.4g s"):format(what,
        task.counts, task.above and "above the limit" or ("below %g of the limit"):format(largest_step.least), task.low, task.high)
    end
  end
  return list
end

function largest_step.draw(path, tasks)
  local curves, of = {}, {}
  for _, task in ipairs(tasks) do
    if task.low and task.high < math.huge then
      local curve = of[task.integrator] or { title = task.integrator, points = {}, lines = false }
      if not of[task.integrator] then curves[#curves + 1], of[task.integrator] = curve, curve end
      curve.points[#curve.points + 1] = { task.low, task.counts / task.low }
    end
  end
  if #curves == 0 then return nil, "nothing was measured" end
  return plot.draw(path, { title = "Estimate of the largest stable step over the measured limit", curves = curves,
    x = { label = "measured limit, s", log = true }, y = { label = "estimate / limit", min = 0, max = 1.2 },
    more = { "1 with lines lw 1.5 lc rgb '#000000' notitle", largest_step.least .. " with lines dt 2 lc rgb '#000000' notitle" } })
end

return largest_step
