-- The lengths of steps: several at once are the single ones, another length voids a history, and a method that chooses its
-- steps takes none that is too long and does not stay at one that is too short.
local method = require("method")
local scenes = require("common.check.integrator.scenes")
local sensitivity = require("sensitivity")

local steps = {}

local STEPS = 10
local H = 1 / 240

-- After a much shorter step the history of longer ones is of no use as it is: what the method then does is near the solution,
-- by rk4 with very small steps, or as near as a fresh start is.
local function goes_on_with_another_step(plugin, lines)
  if plugin.adaptive then return end
  local SHORTER <const>, STEPS_AFTER <const> = 30, 2
  local h = H / SHORTER
  lines:at("the scene 'swing', steps of 1/%d of those before, after reset(step)", SHORTER)
  local run, fresh = scenes.open(plugin, scenes.swing), scenes.open(plugin, scenes.swing)
  local exact = scenes.open({ path = "rk4" }, scenes.swing)
  if not run or not exact then return end
  local X = method.run(run, { h = H, steps = STEPS }).X
  method.reset(run, "step")
  local options = { X = X, t = STEPS * H, h = h, steps = STEPS_AFTER }
  local after, alone = method.run(run, options).X, method.run(fresh, options).X
  options.h, options.steps = h / 64, 64 * STEPS_AFTER
  local true_X = method.run(exact, options).X
  local last = 6 * 3
  local off, own = scenes.distance(after, true_X, 1, last), scenes.distance(alone, true_X, 1, last)
  local moved = scenes.distance(true_X, X, 1, last)
  if off > math.max(5e-4 * moved, 8 * own) or off ~= off then
    lines:wrong(("after another step length it goes on with the history of the old one: %.2g off, of a change by %.2g; a fresh"
      .. " start is %.2g off"):format(off, moved, own),
      "on HK_STEP_CHANGED forget the slopes before, or weigh them by the lengths of their steps")
  end
end

-- From a step that is far too long for the tolerance: what it takes must be shorter, and as exact as was asked for; a looser
-- tolerance must let it take a longer one, and its proposal must hang on it.
local function rejects_long_steps(plugin, lines)
  if not plugin.adaptive then return end
  local LONG <const>, LENIENT <const> = 0.5, 1e4 -- s; a tolerance is asked for, and met in other measures
  local taken, proposed = {}, {}
  for k, tol in ipairs { 1e-3, 1e-8 } do
    lines:at("the scene 'swing', a first step of %g s with tol = %g", LONG, tol)
    local run, exact = scenes.open(plugin, scenes.swing, { tol = tol }), scenes.open({ path = "rk4" }, scenes.swing)
    if not run or not exact then return end
    local r = method.run(run, { h = LONG, stop = 2 * LONG, steps = 1 })
    if r.status ~= 0 or r.error ~= r.error then return end -- it estimates nothing, or says why it cannot
    if r.error > 1 + 1e-9 then
      return lines:wrong(("it takes a step whose error it estimates to be %.3g times the tolerance"):format(r.error),
        "take a step back whose estimate is above 1, and try a shorter one")
    end
    local parts = math.max(64, math.ceil(r.h * 20000))
    local off = scenes.distance(r.X, method.run(exact, { h = r.h / parts, steps = parts }).X, 1, 18)
    if off > LENIENT * tol or off ~= off then
      return lines:wrong(("with tol = %g it takes a step of %.3g s that is %.2g off"):format(tol, r.h, off),
        "take a step back whose estimate is above 1, and try a shorter one")
    end
    taken[k], proposed[k] = r.h, r.h_next
  end
  if taken[1] == taken[2] and proposed[1] == proposed[2] then
    lines:wrong(("steps of %.3g s are taken and %.3g s proposed with any tolerance"):format(taken[1], proposed[1]),
      "choose the step by the estimate")
  end
end

-- The step from step to step, in a scene where nothing happens: what the estimate says is that it may grow.
local function grows_where_it_may(plugin, lines)
  if not plugin.adaptive then return end
  lines:at("the scene 'swing', from a step of 1e-7 s with tol = 1e-3")
  local run = scenes.open(plugin, scenes.swing, { tol = 1e-3 })
  local r = run and method.run(run, { h = 1e-7, stop = 0.2, steps = 40 })
  if not r or r.status ~= 0 or r.error ~= r.error then return end
  if r.h_next <= 1e-6 and r.t < 0.2 then
    lines:wrong(("from steps of 1e-07 s, whose error is estimated to be %.2g of the tolerance, it proposes %.2g s after 40 steps"
      ):format(r.error, r.h_next), "propose a longer step where the estimate is far below 1")
  end
end

-- Lengths of tiles, in turn, 0 for a step alone: odd and even ones, the longest, and such that histories go from one kind of
-- step to the other.
local LENGTHS <const> = { { 1 }, { 3 }, { 30 }, { 2 }, { 5, 0, 7, 1, 0, 0, 4 }, { 32 } }
local tile_scenes = { { "swing", 64, LENGTHS }, { "damped", 64, LENGTHS },
  { "curtain", 26, { { 5, 0, 7 }, { 26 } } } }

local function same_times(a, b)
  for k = 1, math.max(#a, #b) do
    if not a[k] or not b[k] or math.abs(a[k] - b[k]) > 1e-12 then return false end
  end
  return true
end

-- Steps by `steps` of the facet tile and by `step`: both sum the same numbers in the same order, at the
-- same times.
local function tiles_as_it_steps(plugin, lines)
  if not plugin.tiles then return end
  local START <const>, told = 1.7, false
  for _, entry in ipairs(tile_scenes) do
    local name, number = entry[1], entry[2]
    lines:at("the scene '%s'", name)
    local one_by_one = method.run(scenes.open(plugin, scenes[name]), { t = START, h = H, steps = number })
    local stepped = one_by_one.X
    for _, lengths in ipairs(entry[3]) do
      local text = table.concat(lengths, ", ")
      lines:at("the scene '%s', tiles of %s steps", name, text)
      local X, tiled, changed, status, times =
        method.tile(scenes.open(plugin, scenes[name]), { t = START, h = H, steps = number, lengths = lengths })
      local off = 0
      for k = 1, #X do off = (X[k] ~= X[k] or math.abs(X[k] - stepped[k]) > off) and math.abs(X[k] - stepped[k]) or off end
      local wrong = status ~= 0 and ("`steps` of the facet tile fails with status %d"):format(status)
        or changed and "`steps` of the facet tile changes X, which its host needs if it fails"
        or tiled == 0 and "`steps` of the facet tile never takes a step"
        or (off ~= off or off >= 1e-12) and
        ("%d steps by `steps` of the facet tile, %s at once, differ by %.2g from those by `step`"):format(number, text, off)
        or not same_times(times, one_by_one.times) and ("tiles of %s steps evaluate at other times than single steps"):format(text)
      if wrong and not told then
        told = true
        lines:wrong(wrong, "the first step goes from X to `spare`, the others in place, with t[k] at their ends; the history goes along")
      end
    end
  end
end

-- The scene, with the algebraic error of an implicit method's steps as small as it may be asked for.
local function open_exactly(plugin)
  local params = { tolerance = 1e-12 }
  for name, value in pairs(plugin.given or {}) do params[name] = value end
  local run, scene
  if plugin.implicit then run, scene = scenes.open(plugin, scenes.damped, { params = params }) end
  if run then return run, scene end
  return scenes.open(plugin, scenes.damped)
end

-- What the facet states of the stages, taken again over steps whose length changes on the way: rounding is left, and an
-- implicit method's algebraic error.
local function stages_are_its_step(plugin, lines)
  if not plugin.facets:find("stages/1", 1, true) then return end
  lines:at("the scene 'damped', 0.1013 s in steps of %.3g s and a shorter one", H)
  local run, scene = open_exactly(plugin)
  if not run then return end
  local most = plugin.implicit and 1e-10 or 1e-12
  local record, why = sensitivity.record(run)
  if not record then return lines:wrong(why, "see core/plugin/facets/stages.h") end
  scene:run { to = 0.1 }
  scene:run { to = 0.1013 }
  local off, reason = record:finish()
  if not off or off > most then
    lines:wrong(off and ("steps by the facet stages differ from those of `step` by %.2g"):format(off) or reason,
      "x_kj is A A and X is b A for a method of Runge and Kutta; `carries` is for an acceleration that the next step begins with")
  end
end

steps.list = {
  { "its stages are its step", stages_are_its_step },
  { "steps at once are its steps", tiles_as_it_steps },
  { "a step of another length", goes_on_with_another_step },
  { "steps that are too long", rejects_long_steps },
  { "steps that are too short", grows_where_it_may },
}

return steps
