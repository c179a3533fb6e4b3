-- What an integrator owes its host: it stays within its arrays and its instance, passes on failures, tells what it did,
-- forgets its history when told to, advances all of X, and is what its flags say.
local inspect = require("inspect")
local members = require("members")
local method = require("method")
local scenes = require("common.check.integrator.scenes")

local habits = {}

local STEPS = 10
local H = 1 / 240
local FAILED, NOT_CONVERGED = 2, 6 -- hk_status
local ORDINARY = { "swing", "damped", "driven", "channels" }

-- The same for fixed-step and adaptive methods: about STEPS steps.
local function go(plugin, run, more)
  local options = plugin.adaptive and { stop = STEPS * H, h = H } or { h = H, steps = STEPS }
  for key, value in pairs(more or {}) do options[key] = value end
  return method.run(run, options)
end

local function each_scene(plugin, lines, body, options)
  for _, name in ipairs(ORDINARY) do
    lines:at("the scene '%s'", name)
    local run, why = scenes.open(plugin, scenes[name], options)
    if run then body(run, name)
    elseif name == "swing" then error(why, 0) end
  end
end

local function same(a, b)
  for k = 1, #a do
    if a[k] ~= b[k] and (a[k] == a[k] or b[k] == b[k]) then return false, k, a[k], b[k] end
  end
  return true
end

-- ---- memory ----

local function stays_within_its_arrays(plugin, lines)
  for before = 0, 1 do
    each_scene(plugin, lines, function(run) go(plugin, run, { before = before }) end)
  end
end

local function reads_what_was_written(plugin, lines)
  local first, told = {}, false
  for round, fill in ipairs { 0, 0xc1 } do
    inspect.fill(fill)
    each_scene(plugin, lines, function(run, name)
      local X = go(plugin, run, { scratch = fill, steps = plugin.adaptive and 100 or nil }).X
      if round == 1 then first[name] = X return end
      local fine, k, a, b = same(first[name], X)
      if fine or told then return end
      told = true
      lines:wrong(("it reads memory that was not written, or scratch fields of the step before: X[%d] is %.17g, then %.17g"
        ):format(k - 1, a, b), "fields with HK_SCRATCH hold nothing between steps; memory of malloc has to be filled")
    end)
  end
end

local function allocates_nothing(plugin, lines)
  local told
  local before, freed_before = inspect.heap()
  each_scene(plugin, lines, function(run)
    go(plugin, run)
    local a, left = inspect.heap(), members.left(run)
    method.run(run, { h = H, steps = 3, t = STEPS * H, stop = (STEPS + 3) * H })
    local calls, asked = inspect.heap() - a, left - members.left(run)
    if calls + asked > 0 and not told and not plugin.solves then
      told = true
      lines:wrong(("it allocates in a step: %d times in three steps"):format(calls + asked), "allocate in `create` and `topology`")
    end
    inspect.destroy(run)
  end, { allocations = 1 << 40 })
  local allocated, freed = inspect.heap()
  local lost = (allocated - before) - (freed - freed_before)
  if lost > 0 then
    lines:wrong(("it leaks memory: %d of %d blocks of malloc were not freed"):format(lost, allocated - before),
      "free them in `destroy`, or take them from host->allocate")
  end
end

local function keeps_to_its_instance(plugin, lines)
  lines:at("the scene 'swing', beside an instance in the scene 'damped'")
  local alone = scenes.open(plugin, scenes.swing)
  local X = go(plugin, alone).X
  X = go(plugin, alone, { X = X }).X
  local first, second = scenes.open(plugin, scenes.swing), scenes.open(plugin, scenes.damped)
  local beside = go(plugin, first).X
  if second then go(plugin, second) end
  beside = go(plugin, first, { X = beside }).X
  local fine, k, a, b = same(X, beside)
  if not fine then
    lines:wrong(("it depends on another instance: X[%d] is %.17g, then %.17g"):format(k - 1, a, b),
      "keep all data in the instance, no static variables")
  end
end

local function agrees_on_any_threads(plugin, lines)
  local first
  for _, threads in ipairs { 1, 2, 3, 8 } do
    for round = 1, 2 do
      local reversed = threads == 1 and round == 2
      lines:at("a sheet of 16 x 16 with %d threads%s", threads,
        reversed and ", the chunks of parallel_for in reverse order" or "")
      local run = scenes.open(plugin, scenes.sheet, { threads = threads })
      if not run then return end
      if reversed then method.reverse(run) end
      local X = method.run(run, plugin.adaptive and { stop = 2 * H, h = H } or { h = H, steps = 2 }).X
      first = first or X
      local fine, k, a, b = same(first, X)
      if not fine then
        return lines:wrong(("X is not the same with several threads: X[%d] is %.17g, then %.17g"):format(k - 1, a, b),
          "let no two chunks write the same number, and sum in the order of chunks")
      end
    end
  end
end

-- ---- its contract ----

local function says_what_it_did(plugin, lines)
  local told = {}
  local function once(key, ...)
    if not told[key] then told[key] = true lines:wrong(...) end
  end
  each_scene(plugin, lines, function(run)
    for _, t in ipairs { 0, 2.5 } do
      if t > 0 then method.reset(run, "state") end
      local r = plugin.adaptive and method.run(run, { t = t, h = 10 * H, stop = t + 3 * H, steps = 1 })
        or method.run(run, { t = t, h = H, steps = 2 })
      if r.status ~= 0 then once("fails", "a step fails: " .. r.message, "see the message") end
      if r.moved_time then once("time", "it moves s->t, which is the host's", "leave s->t alone: the host moves it") end
      if r.changed_system then once("system", "it changes X, n or size of the system", "write into s->X, leave the pointer") end
      if r.h ~= r.h then once("h", "it does not say what step it took: out->h", "set out->h") end
      if plugin.adaptive and r.h == r.h then
        if r.h_next <= 0 or r.h_next ~= r.h_next then once("next", ("out->h_next is %g s"):format(r.h_next), "propose a step above 0") end
        if r.h <= 0 or r.h > 3 * H * (1 + 1e-9) then
          once("beyond", ("it steps %g s, beyond t_stop at %g s"):format(r.h, 3 * H), "end at t_stop: shorten the step")
        end
        if r.error < 0 then once("error", ("out->error is %g"):format(r.error), "1 is just met; NAN where there is none") end
      elseif not plugin.adaptive and r.h == r.h and r.h ~= H then
        once("fixed", ("it reports a step of %g s, given %g s"):format(r.h, H), "fixed-step methods take h exactly")
      end
      local most = t + (plugin.adaptive and 3 or 2) * H
      for _, time in ipairs(r.times) do
        if time < t - 1e-12 or time > most + 1e-12 then
          once("stage", ("it evaluates at t = %.9g s in a step from %.9g s to %.9g s at most"):format(time, t, most),
            "stages lie between the step's ends: s->t + c h")
        end
      end
      if r.splits and plugin.constrained and not plugin.splits then
        once("splits", "it leaves forces out by `takes` and does not claim HK_SPLITS_FORCES", "claim it")
      end
    end
  end)
end

-- Every call of the host fails in turn.
local calls = { [0] = "accelerations", "jacobian", "factorize", "solve" }

local function passes_on_failures(plugin, lines)
  local told = {}
  for _, name in ipairs { "swing", "damped" } do
    for what = 0, 3 do
      for at = 1, 6 do
        local run = scenes.open(plugin, scenes[name])
        if not run then break end
        lines:at("the scene '%s', where %s fails from call %d on", name, calls[what], at)
        local start = method.state(run)
        local options = { fail_what = what, fail_at = at, fail_with = FAILED, h = H, steps = 2, stop = 2 * H }
        local r = method.run(run, options)
        -- Iterations may try again, with other factors, what fails once.
        options.fail_once = plugin.implicit and 0 or 1
        local once = scenes.open(plugin, scenes[name])
        local ignored = not plugin.implicit and method.run(once, options).status == 0
        options.fail_once = 0
        local counts = { [0] = r.evaluations, r.jacobians, r.factorizations, r.solves }
        if counts[what] < at then break end
        if (r.status == 0 or ignored) and not told[what] then
          told[what] = true
          lines:wrong(("it goes on when %s fails"):format(calls[what]), "return every status that is not HK_OK")
        end
        options.fail_with = NOT_CONVERGED
        run = scenes.open(plugin, scenes[name])
        options.steps = 1
        r = method.run(run, options)
        if r.status == NOT_CONVERGED and not same(start, r.X) and not told.X then
          told.X = true
          lines:wrong("after HK_NOT_CONVERGED X is not as it was", "work on a copy; the host tries a smaller step")
        end
      end
    end
  end
end

local function advances_everything(plugin, lines)
  lines:at("the scene 'channels'")
  local run, why = scenes.open(plugin, scenes.channels)
  if not run then return lines:note("channels: " .. why) end
  local start, n = method.state(run)
  local X = go(plugin, run).X
  for k = 1, 3 * n do
    if k > 3 and (X[k] == start[k] and X[3 * n + k] == start[3 * n + k]) then
      return lines:wrong(("particle %d does not move"):format((k - 1) // 3 + 1), "advance all of x and v")
    end
  end
  for k = 6 * n + 1, #X - 1 do
    if X[k] == start[k] then
      return lines:wrong(("channel number %d does not advance: the y behind x and v"):format(k - 6 * n - 1),
        "s->X has size numbers: y starts at 6n, and is integrated with dy")
    end
  end
  lines:at("the scene 'damped'")
  local damped = scenes.open(plugin, scenes.damped)
  if not damped then return end
  X = go(plugin, damped).X
  if X[#X] == 0 then
    lines:wrong("the work of non-conservative forces does not advance: the last number of X",
      "integrate all of y, to X[size - 1]")
  end
end

-- ---- history ----

-- The state after a jump: with the history forgotten the same as from a fresh start.
local function forgets(plugin, lines)
  for _, why in ipairs { "state", "step", "particles" } do
    lines:at("the scene 'swing', a jump of the state after %d steps and reset(%s)", STEPS, why)
    local run, fresh = scenes.open(plugin, scenes.swing), scenes.open(plugin, scenes.swing)
    if not run then return end
    local X = go(plugin, run).X
    local n = 3
    if why ~= "step" then
      for k = 4, 3 * n do
        X[k] = X[k] + 0.1 * math.sin(k)
        X[3 * n + k] = -X[3 * n + k] + math.cos(k)
      end
    end
    method.reset(run, why)
    local h = why == "step" and H / 3 or H
    local options = plugin.adaptive and { X = X, t = STEPS * H, stop = STEPS * H + 2 * h, h = h }
      or { X = X, t = STEPS * H, h = h, steps = 2 }
    local after, expected = method.run(run, options), method.run(fresh, options)
    local moved = scenes.distance(expected.X, X)
    -- Iterations start elsewhere; a forgotten reset changes the step by much of itself.
    local most = 0.02 * moved
    if why == "step" then most = 0.1 * moved end -- a method may go on from its history with other coefficients
    local off = scenes.distance(after.X, expected.X)
    if off > most or off ~= off then
      return lines:wrong(("it goes on with its history after reset: %.2g m off, of a move of %.2g m"):format(off, moved),
        "forget previous steps and cached accelerations in `reset`")
    end
  end
end

local function follows_births_and_deaths(plugin, lines)
  lines:at("a sheet of 16 x 16, where two particles die and one is born")
  local run, fresh = scenes.open(plugin, scenes.sheet), scenes.open(plugin, scenes.sheet)
  if not run then return end
  local before = method.run(run, plugin.adaptive and { stop = 3 * H, h = H } or { h = H, steps = 3 })
  if before.status ~= 0 then return lines:wrong("a step fails: " .. before.message, "see the message") end
  for _, r in ipairs { run, fresh } do
    members.change(r, { 5, 40 }, { { 0.5, 0.5, 0.5 } })
    method.reset(r, "particles")
  end
  local options = plugin.adaptive and { stop = 2 * H, h = H } or { h = H, steps = 2 }
  options.X = method.state(fresh)
  local X, Y = method.run(run, options), method.run(fresh, options)
  local moved = scenes.distance(Y.X, options.X)
  local off = scenes.distance(X.X, Y.X)
  if X.status ~= Y.status or off > 0.02 * moved or off ~= off then
    lines:wrong(("after births and deaths it differs from a fresh start: %.2g m off, of a move of %.2g m"):format(off, moved),
      "rebuild in `topology` what depends on the number of particles; forget the history in `reset`")
  end
end

local function survives_no_particles(plugin, lines)
  lines:at("a sheet, where all particles die")
  local run = scenes.open(plugin, scenes.sheet)
  if not run then return end
  go(plugin, run)
  local all = {}
  for i = 1, 256 do all[i] = i - 1 end
  members.change(run, all, {})
  method.reset(run, "particles")
  go(plugin, run)
end

-- ---- flags ----

-- How far the state X of the scene 'linkage' is from its bars, m and m/s.
local function off_the_bars(X)
  local worst = 0
  for k = 1, #scenes.joints - 1 do
    local length, now, rate = 0, 0, 0
    for c = 1, 3 do
      local d, u = X[3 * k + c] - X[3 * k - 3 + c], X[9 + 3 * k + c] - X[9 + 3 * k - 3 + c]
      length, now, rate = length + (scenes.joints[k + 1][c] - scenes.joints[k][c]) ^ 2, now + d * d, rate + d * u
    end
    worst = math.max(worst, math.abs(math.sqrt(now) - math.sqrt(length)), math.abs(rate) / math.sqrt(now))
  end
  return worst
end

local function keeps_constraints(plugin, lines)
  lines:at("the scene 'linkage'")
  local run, why = scenes.open(plugin, scenes.linkage)
  if not run then error(why, 0) end
  local off = off_the_bars(method.run(run, plugin.adaptive and { h = H, stop = 10 * H } or { h = H, steps = 10 }).X)
  if off > 1e-12 or off ~= off then
    lines:wrong(("it claims to keep constraints, and ten steps leave bars of 1 m by %.2g m or m/s"):format(off),
      "call `shake` and `rattle` of hk_system.constraint, or drop `keeps`")
  end
end

local FIRST_STEPS = 8 -- in which a method of many steps makes its history

local function is_what_its_flags_say(plugin, lines)
  local function remedy(flag) return ("the flags of hk_integrator: %s"):format(flag) end
  lines:at("the scene 'swing'")
  local run, why = scenes.open(plugin, scenes.swing)
  if not run then error(why, 0) end
  local first = method.run(run, plugin.adaptive and { h = H, stop = 2 * H } or { h = H, steps = FIRST_STEPS })
  local later = method.run(run, plugin.adaptive and { X = first.X, t = 2 * H, h = H, stop = 6 * H }
    or { X = first.X, t = FIRST_STEPS * H, h = H, steps = 10 })
  local solved = first.factorizations + first.solves + later.factorizations + later.solves
  local jacobians = first.jacobians + later.jacobians
  if jacobians > 0 and not plugin.needs_jacobian then
    lines:wrong("it asks for Jacobians and does not claim HK_NEEDS_JACOBIAN", remedy("claim it"))
  elseif jacobians == 0 and plugin.needs_jacobian then
    lines:wrong("it claims HK_NEEDS_JACOBIAN and asks for none", remedy("drop it, or HK_IMPLICIT as well"))
  end
  if solved > 0 and not (plugin.needs_solver or plugin.needs_jacobian) then
    lines:wrong("it solves linear systems and does not claim HK_NEEDS_SOLVER", remedy("claim it"))
  end
  if not plugin.implicit and not plugin.adaptive then
    local per_step = later.evaluations / later.taken
    lines:add(per_step == plugin.stages, ("%d evaluations a step"):format(plugin.stages), ("%.3g"):format(per_step), nil,
      "`stages` is the number of evaluations of f per step, those of the first steps apart")
  elseif later.evaluations == 0 then
    lines:wrong("it takes steps without an evaluation of f", "see hk_system.accelerations")
  end
  if plugin.keeps_constraints then keeps_constraints(plugin, lines) end
  if plugin.limits_moves then
    local contact = scenes.open(plugin, scenes.swing)
    local r = contact and method.run(contact, { h = H, steps = 1, stop = H, contact = 1 })
    if r and r.moves == 0 then
      lines:wrong("it claims HK_LIMITS_MOVES and moves without hk_system.contact's `update`",
        remedy("drop it, or call update and step_limit"))
    end
  end
end

habits.list = {
  { "it stays within the state", stays_within_its_arrays },
  { "it says what it did", says_what_it_did },
  { "it is what its flags say", is_what_its_flags_say },
  { "it passes on failures", passes_on_failures },
  { "it advances all of X", advances_everything },
  { "it reads no memory that was not written", reads_what_was_written },
  { "it allocates nothing in a step and leaks nothing", allocates_nothing },
  { "it keeps nothing outside its instance", keeps_to_its_instance },
  { "the same bits with 1 to 8 threads", agrees_on_any_threads },
  { "it forgets its history when told to", forgets },
  { "births and deaths", follows_births_and_deaths },
  { "no particles are left", survives_no_particles },
}

return habits
