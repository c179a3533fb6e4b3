-- hooke auto SCENE.lua [name=value ...] --accuracy METRES: the integrator and the step that cost least, by measuring.
-- Chosen are the integrator, and its step, tolerance or substeps, that compute the scene's positions with this accuracy
-- at the least cost. `hooke run --integrator auto` runs this tool.
--
-- A short bench (tools/common/bench/benchmark.lua) of the first part of the scene, as much as a few seconds allow, with
-- the methods of order 2 and more. Errors accumulate: a fraction of the duration may have this fraction of the error,
-- and of it a quarter, since the run is judged (core/run/run/verify.c) at all frames, and in doubt by a bound of its error.
-- Where the runs of a method did not reach this error, its setting is extrapolated from its last two errors. Where the
-- whole run is affordable, it is tried with the choice (tools/common/bench/trial.lua): what comes late, such as a
-- collision, the first part does not show. The choice is stored under a hash of the scene's text, its parameters, the
-- accuracy, the end and the plugins' contents.
local argparse = require("argparse")
local trial = require("common.bench.trial") -- before the bench, which runs cases in another way
local accuracy_search = require("common.bench.accuracy_search")
local methods = require("common.bench.methods")
local benchmark = require("common.bench.benchmark")
local refinement = require("common.bench.refinement")
local command_line = require("common.run.command_line")
local files = require("common.run.file")
local process = require("process")
local journal = require("common.bench.journal")
local case_process = require("common.run.case_process")

local margin = 1 / 4
local reference_costs = 10                -- approximate cost of the reference, in runs of leapfrog
local as_cheap = 1.2                      -- costs closer than this are the same, to what measuring can tell
local doubt = 1.3                          -- what is extrapolated has to be so much cheaper
local rule = 3                             -- to be raised when the choice is made in another way: what is on file is void
local reference_margin = 10               -- errors this many times the reference's own tell methods apart
local least_frames = 4
local most_adaptive = 2                   -- methods that are tried on the whole run beside the first
local probe_part, start_seconds = 0.15, 0.2 -- of the budget; s, a bound of the start of a process

local function parser()
  local p = argparse("hooke auto", "Chooses an integrator and its step by measuring.")
  p:argument("scene", "the scene's script")
  p:argument("params", "name=value: parameters of the scene"):args("*")
  p:option("--accuracy", "of the positions, RMS, m"):convert(command_line.number("--accuracy"))
  p:option("--until", "end of the run, s"):target("until_"):convert(command_line.number("--until"))
  p:option("--budget", "s that measuring may take, about"):default("6")
    :convert(command_line.number("--budget"))
  p:flag("--again", "measure even if a choice is on file")
  p:flag("--quiet", "say nothing")
  p:flag("--trust", "the scene is trusted")
  return p
end

local function complain(format, ...)
  return command_line.complain("auto", format:format(...))
end

-- ---- the stored choice ----

local function folder()
  local base = os.getenv("XDG_CACHE_HOME")
  if not base or base == "" then
    local home = os.getenv("HOME")
    base = home and home ~= "" and home .. "/.cache" or nil
  end
  return base and base .. "/hooke"
end

local function is_setting(x) return x == nil or type(x) == "number" and x > 0 and x < math.huge end

local function is_integrator(name)
  for _, p in ipairs((hooke.catalogue())) do
    if p.kind == "integrator" and p.name == name then return true end
  end
  return false
end

-- What is damaged, or names what there is no more, is measured again.
local function stored_choice(path)
  local text = path and journal.read(path)
  local fine, choice = pcall(journal.json.decode, text or "")
  fine = fine and type(choice) == "table" and type(choice.integrator) == "string" and type(choice.why) == "string"
    and is_setting(choice.dt) and is_setting(choice.tol) and is_integrator(choice.integrator:match("^[^:]*"))
  return fine and choice or nil
end

-- Returns whether the choice is on file.
local function store_choice(path, choice)
  if not path then return false end
  os.execute("mkdir -p '" .. path:match("^(.*)/"):gsub("'", "'\\''") .. "'")
  local fine, why = files.write(path, journal.json.encode(choice) .. "\n")
  if not fine then complain("the choice is not kept: %s", why) end
  return fine
end

-- ---- the length of the benchmark ----

-- An explicit and an implicit method that show what a scene costs, stiff or not.
local probes = { { integrator = "leapfrog" }, { integrator = "esdirk4", tol = 1e-3 } }

-- Of the probes the least processor time per simulated second, from the first frames.
local function cost_of_scene(o, tried)
  local least = probe_part * o.budget
  for _, probe in ipairs(probes) do
    local result = case_process.run { scene = o.scene, params = o.params, integrator = probe.integrator, tol = probe.tol,
      ["until"] = tried, allowance = least + start_seconds, trust = o.trust }
    least = math.min(result.step_s or least, least)
  end
  return least / tried
end

local function benchmark_end(o, explained)
  local whole = o.until_ or explained.duration
  local frame = 1 / explained.fps
  local cost = cost_of_scene(o, math.min(whole, least_frames * frame))
  local afford = 0.3 * o.budget / (reference_costs * math.max(cost, 1e-9))
  if afford >= whole then return whole end
  return math.min(whole, math.max(least_frames, math.floor(afford * explained.fps)) * frame)
end

-- ---- from errors to a choice ----

local function cost(s) return s.extrapolated and doubt * s.wall or s.wall end

local function is_cheaper(a, b) return cost(a) < cost(b) end

-- The methods by their cost at the target, each with the setting for it.
local function ranking(b)
  local list = {}
  for _, method in ipairs(b.methods) do list[#list + 1] = accuracy_search.cheapest(method, b.goal, b.goal.target) end
  table.sort(list, is_cheaper)
  return list
end

-- Of methods that cost as much at the target, the one that costs least with the margin, with the setting for that: the
-- two first in this order. The runs that show it take some part of the budget.
local function best_two(b, o)
  local list, near, methods_near = ranking(b), {}, {}
  local strict = setmetatable({ target = math.max(margin * b.goal.target, b.goal.support) }, { __index = b.goal })
  for _, s in ipairs(list) do
    if s.wall <= as_cheap * list[1].wall then
      near[#near + 1], methods_near[#methods_near + 1], s.method.settled = s, s.method, 0
    end
  end
  refinement.settle(methods_near, b, strict, 0.2 * o.budget)
  for k, s in ipairs(near) do near[k] = accuracy_search.cheapest(s.method, strict, strict.target) or s end
  table.sort(near, is_cheaper)
  return near[1], near[2] or list[2]
end

-- ---- the choice ----

local function phrase(s, b)
  return ("%s, %s (%s %.1e m at %.2g s per simulated second)"):format(s.method.label, methods.setting_text(s.setting),
    s.expected and "expected" or "measured", s.error, s.wall / b.limit)
end

-- The step of a setting. The first setting of an explicit method is the step that a run chooses itself, and shortens
-- when the scene stiffens: no step is then given, unless the scene has its own dt.
local function step_of(s, b)
  local own = not s.expected and not s.refined and s.row == s.method.rows[1] and not s.method.implicit and s.method.by == "dt"
  if own and b.explained.dt_chosen then return nil end
  return s.setting.dt
end

-- The first, and of others the cheapest that choose their steps themselves, for these see what comes late.
local function candidates_for_trial(first, b)
  local list, adaptive = { first }, 0
  for _, s in ipairs(ranking(b)) do
    if s.method ~= first.method and s.setting.tol and adaptive < most_adaptive then
      list[#list + 1], adaptive = s, adaptive + 1
    end
  end
  return list
end

-- Returns the candidate that is ok over the whole run, or else the one that came nearest, and words on it.
local function tried_on_the_whole(first, b, o, whole)
  local good, count, nearest = trial.first_ok(candidates_for_trial(first, b), {
    scene = o.scene, params = o.params, trust = o.trust, until_ = o.until_, accuracy = o.accuracy, fps = b.fps,
    budget = o.budget, times = whole / b.limit, step_of = function(s) return step_of(s, b) end })
  if count == 0 then return first, "the whole run takes more than measuring may, and was not tried" end
  if good then return good, ("ok over the whole run, after %d trial%s"):format(count, count > 1 and "s" or "") end
  return nearest or first, ("none of %d trials of the whole run was ok, and this is expected to be"):format(count)
end

local function measure(o)
  local explained, why = hooke.explain(o.scene, o.params, { trust = o.trust })
  if not explained then return nil, why end
  local whole, part = o.until_ or explained.duration, benchmark_end(o, explained)
  local target = o.accuracy * part / whole
  local b
  for _ = 1, 3 do
    b, why = benchmark.new { scene = o.scene, params = o.params, until_ = part, target = target, finest = margin * target,
      budget = o.budget, metric = "x", only_best = true, margin = reference_margin, trust = o.trust }
    if not b then return nil, why end
    local fine
    fine, why = benchmark.measure(b, function() end)
    if fine then break end
    b, part = nil, math.max(part / 4, least_frames / explained.fps)
    target = o.accuracy * part / whole
  end
  if not b then return nil, why end
  target = o.accuracy * b.limit / whole -- the measured time may be shorter than planned
  b.goal.target = math.max(target, b.goal.support)
  local first, second = best_two(b, o)
  if not first then
    return nil, ("no integrator came to %.2g m in the first %.3g s, which %g m at %.4g s take: ask less, or name one")
      :format(b.goal.target, b.limit, o.accuracy, whole)
  end
  local chosen, words = tried_on_the_whole(first, b, o, whole)
  if chosen.method ~= first.method then second = first end
  first = chosen
  local text = ("%s; %.1e m may be used up over the first %.3g s of %.4g s"):format(phrase(first, b), b.goal.target,
    b.limit, whole)
  text = ("%s; %s"):format(text, words)
  if second then text = ("%s; the next is %s"):format(text, phrase(second, b)) end
  if b.goal.target > target then
    text = ("%s; %.1e m were meant to be, and errors below %.1e m cannot be told here"):format(text, target,
      b.goal.support)
  end
  if b.horizon then
    text = ("%s; beyond %.3g s two good methods part%s"):format(text, b.horizon, b.cut_from.late
      and ", in the time given" or ": the motion is not determined there")
  end
  return { integrator = first.setting.integrator, dt = step_of(first, b), tol = first.setting.tol, why = text }
end

local function main()
  local o = command_line.parse("auto", parser())
  if not o then return 1 end
  local params = {}
  for _, word in ipairs(o.params) do
    local name, value = word:match("^([%w_]+)=(.*)$")
    if not name then return complain("'%s' is not name=value", word) end
    params[name] = value
  end
  o.params = params
  if not (o.accuracy and o.accuracy > 0) then
    return complain("--accuracy METRES is needed, such as --accuracy 1e-3")
  end
  local place = folder()
  local path = place and ("%s/auto-%s.json"):format(place, journal.hash(journal.of_scene(o.scene, params)
    .. journal.canonical { accuracy = o.accuracy, until_ = o.until_, rule = rule }))
  local choice, begun = not o.again and stored_choice(path), process.clock()
  local known, kept = choice ~= nil and choice ~= false, false
  if not known then
    local why
    choice, why = measure(o)
    if not choice then return complain("%s", why) end
    choice.scene, choice.accuracy, choice.seconds = o.scene, o.accuracy, process.clock() - begun
    kept = store_choice(path, choice)
  end
  if not o.quiet then
    io.stderr:write(("hooke: auto: %s\n"):format(hooke.plain(choice.why)))
    io.stderr:write(known and ("hooke: auto: chosen before, from %s\n"):format(hooke.plain(path))
      or ("hooke: auto: measured in %.2g s%s\n"):format(choice.seconds, kept and ", kept in " .. path or ""))
  end
  if hooke.chosen then hooke.chosen(choice.integrator, choice.dt, choice.tol) end
  return 0
end

return main()
