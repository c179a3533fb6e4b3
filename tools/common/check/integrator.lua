-- The tests of an integrator (hooke check): measured order, stability limits and reversibility.
local amplification = require("amplification")
local states = require("states")

-- ---- scenes ----

-- Two masses on a string of springs that is released sideways; the scene also suits methods that work element by
-- element.
local function swing(plugin, options)
  local scene = hooke.scene { duration = options.duration or 0.5, fps = options.fps or 60, dt = options.dt,
    tol = options.tol }
  scene:integrator(plugin.path, plugin.given)
  local points = options.points or { { 0, 0, 0 }, { 1, 0, 0.1 }, { 1.7, 0.4, -0.5 } }
  local ids = {}
  for k, x in ipairs(points) do
    ids[k] = scene:particle { position = x, velocity = options.velocities and options.velocities[k], mass = 1 }
  end
  scene:pin { ids[1] }
  scene:force("gravity", {})
  scene:force("springs", { edges = { { ids[1], ids[2] }, { ids[2], ids[3] } }, k = 100, rest = 0.9 })
  return scene, ids
end

local OFFSET = 1e-8 -- m, of a spring of 1 m: linear to the eighth digit, and growth by a million still to the second

-- One particle on a spring to a pin, displaced from rest, for `steps` steps of 1/60 s with this h w.
local function oscillator(plugin, hw, damping, steps)
  local w = 60 * hw
  local scene = hooke.scene { duration = steps / 60, fps = 60, dt = 1 / 60 }
  scene:integrator(plugin.path, plugin.given)
  local a = scene:particle { position = { 0, 0, 0 }, mass = 1 }
  local b = scene:particle { position = { 1 + OFFSET, 0, 0 }, mass = 1 }
  scene:pin { a }
  scene:force("springs", { edges = { { a, b } }, k = w * w, damping = 2 * damping * w, rest = 1 })
  return scene, b
end

-- The packed state at the end, or nil and the reason.
local function end_state(scene)
  local fine, run = pcall(scene.run, scene)
  if not fine then return nil, tostring(run) end
  return run:packed(), run
end

local function distance(a, b) return states.distance(a, b).x_rms end

-- ---- order ----

-- Differences of runs at h, h/2, h/4, h/8: the ratio of two successive differences is 2^order.
local function order(plugin, report)
  local list = {}
  for k = 0, 3 do
    local why
    list[k], why = end_state((swing(plugin, { dt = 1 / 120 / 2 ^ k })))
    if not list[k] then return report:add(false, "it runs", why) end
  end
  local coarse, fine = distance(list[1], list[2]), distance(list[2], list[3])
  local measured = math.log(coarse / fine, 2)
  report:add(measured > plugin.order - 0.25 or fine < 1e-13, ("order %d (from steps of 1/240 to 1/960 s)"):format(
    plugin.order), ("%.2f"):format(measured))
  return fine
end

-- The error of an adaptive method is at most proportional to tol^(p/(p+1)): between 1e-4 and 1e-8 a factor of a hundred
-- for p >= 1. Frames are far apart, so that they do not cut the steps. nil: tol has no effect.
local function tolerance(plugin, report)
  local list = {}
  for k, tol in ipairs { 1e-4, 1e-8, 1e-11 } do
    local why
    list[k], why = end_state((swing(plugin, { tol = tol, duration = 2, fps = 1 })))
    if not list[k] then return report:add(false, ("it runs with tol = %g"):format(tol), why) or true end
  end
  local loose, tight = distance(list[1], list[3]), distance(list[2], list[3])
  if loose == 0 then return nil end
  report:add(tight < loose / 100, "the error falls with tol, from 1e-4 to 1e-8, m",
    ("%.2g to %.2g"):format(loose, tight))
  return true
end

-- ---- stability ----

-- The growth of a perturbation over `steps` steps of h w.
local function growth(plugin, hw, damping, steps)
  local scene, id = oscillator(plugin, hw, damping, steps)
  local state, run = end_state(scene)
  if not state then return math.huge end
  local x = run:state():position(id)
  return math.sqrt((x[1] - 1) ^ 2 + x[2] ^ 2 + x[3] ^ 2) / OFFSET
end

-- Below its limit a motion of a linear oscillator is bounded (by 1/sqrt(1 - 0.97^2) = 4 for leapfrog); above, it grows
-- by the declared factor per step: in the number of steps for which this factor gives 1e12, it must grow by a hundred
-- at least, since the growing mode may be a small part of the start.
local BOUNDED, TOTAL_GROWTH, LEAST_GROWTH, MOST_STEPS = 30, 1e12, 100, 50000

local function grows_above(plugin, report, factor, hw, damping, what)
  local steps = math.ceil(math.log(TOTAL_GROWTH) / math.log(factor(hw, 2 * damping * hw)))
  if steps > MOST_STEPS then return report:note(what .. ": grows too slowly to be measured") end
  local measured = growth(plugin, hw, damping, steps)
  report:add(measured > LEAST_GROWTH, ("%s: growth in %d steps"):format(what, steps), measured)
end

-- The largest h w up to which a declared growth factor is 1, to 1e-9; infinite: beyond 100.
local function limit_of(grows, damping)
  local function stable(hw) return grows(hw, 2 * damping * hw) <= 1 + 1e-9 end
  local low, high = 0, nil
  for k = 1, 10000 do
    if not stable(k / 100) then high = k / 100 break end
    low = k / 100
  end
  if not high then return math.huge end
  for _ = 1, low > 0 and 40 or 0 do
    local middle = (low + high) / 2
    if stable(middle) then low = middle else high = middle end
  end
  return low
end

local function stability(plugin, report)
  local grows = amplification.open(plugin.path)
  if not grows then return report:note("it declares no growth factor: its steps are not chosen by stability") end
  for _, damping in ipairs { 0, 0.1, 1 } do
    local limit = limit_of(grows, damping)
    local what = ("damping ratio %g"):format(damping)
    if limit == 0 then
      grows_above(plugin, report, grows, 0.5, damping, what .. ", no stable step is declared, h w = 0.5")
    elseif limit == math.huge then
      report:most(what .. ", stable at any step: growth at h w = 50", growth(plugin, 50, damping, 300), BOUNDED)
    else
      report:most(("%s, stable up to h w = %.4g: growth at 0.97 of it"):format(what, limit),
        growth(plugin, 0.97 * limit, damping, 300), BOUNDED)
      grows_above(plugin, report, grows, 1.05 * limit, damping, "and not beyond, at 1.05 of it")
    end
  end
end

-- ---- reversibility ----

local function run_reversed(plugin, dt)
  local scene, ids = swing(plugin, { dt = dt })
  local state, run = end_state(scene)
  if not state then return nil, run end
  local now, points, velocities = run:state(), {}, {}
  for k, id in ipairs(ids) do
    points[k] = now:position(id)
    local v = now:velocity(id)
    velocities[k] = { -v[1], -v[2], -v[3] }
  end
  return end_state((swing(plugin, { dt = dt, points = points, velocities = velocities })))
end

-- A run with reversed velocities must return to the start with an error far below that of the steps.
local function reversibility(plugin, report, step_error)
  local dt = 1 / 240
  local back, why = run_reversed(plugin, dt)
  if not back then return report:add(false, "it returns when velocities are turned", why) end
  local begin = (swing(plugin, { dt = dt })):run({ to = 0 }):packed()
  report:most("it returns when velocities are turned, as claimed, m", distance(begin, back), 1e-3 * step_error)
end

-- Checks the integrator that hooke.describe described; `path` and `given` are also fields of it.
local function check(plugin, report)
  if plugin.adaptive and tolerance(plugin, report) then return end
  local step_error = order(plugin, report)
  stability(plugin, report)
  if plugin.reversible and step_error then reversibility(plugin, report, step_error) end
end

return function(plugin, report)
  require("inspect").quiet()
  report:try("its properties", function(lines) check(plugin, lines) end)
end
