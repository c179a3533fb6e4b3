-- Order, stability, and what a method keeps.
local method = require("method")
local scenes = require("common.check.integrator.scenes")

local accuracy = {}

-- ---- order ----

local T = 0.25 -- s, about one swing of the springs (20/s)

-- Differences of runs at h, h/2, h/4, h/8: the ratio of two successive differences is 2^order. Explicit time, velocities
-- and channels each have a scene, since a method may be right without them.
local orders = { { "swing", "" }, { "damped", ", with forces that depend on v" }, { "driven", ", with forces that depend on t" },
  { "channels", ", of the channels", true } }

-- A method that is not consistent converges as well, to something else: the finest run must be as near to that of rk4
-- with very small steps as it is to the one before.
local function compare_with_another(lines, entry, X, duration, change, first, last)
  local exact = scenes.advance({ path = "rk4" }, scenes[entry[1]], duration, math.floor(240 * duration) * 2 ^ 7)
  if not exact then return end
  lines:most(("it converges to the solution of x'' = f%s"):format(entry[2]), scenes.distance(X, exact, first, last),
    4 * change + 1e-9, "the weights must sum to one; rk4 with steps of 1/30,720 s says otherwise")
end

local function order_in(plugin, lines, entry)
  local list = {}
  lines:at("the scene '%s', steps of 1/240 to 1/1920 s", entry[1])
  for k = 0, 3 do
    local X, report = scenes.advance(plugin, scenes[entry[1]], T, 60 * 2 ^ k)
    if not X then
      if entry[1] == "swing" then return lines:wrong("it runs: " .. report, "see the message") end
      return lines:note(("the scene '%s': %s"):format(entry[1], report))
    end
    list[k] = X
  end
  local n = 3 -- particles of these scenes
  local first, last = entry[3] and 6 * n + 1 or 1, entry[3] and #list[0] - 1 or 6 * n
  local coarse = scenes.distance(list[1], list[2], first, last)
  local fine = scenes.distance(list[2], list[3], first, last)
  local measured = math.log(coarse / fine, 2)
  if coarse == 0 then measured = -math.huge end
  local order = plugin.order
  -- Methods that split x from v see velocities and channels in between: what they keep is stated for F(x, t).
  if plugin.symplectic and (entry[1] == "damped" or entry[3]) then order = math.min(order, 2) end
  lines:add(measured > order - 0.25 or (fine < 1e-12 and coarse > 0), ("order %d%s"):format(order, entry[2]),
    ("%.2f"):format(measured), nil, "check the weights of the stages, and the times at which they are evaluated")
  compare_with_another(lines, entry, list[3], T, fine, first, last)
end

local function order(plugin, lines)
  for _, entry in ipairs(orders) do order_in(plugin, lines, entry) end
end

-- An adaptive method: its error is at most proportional to tol^(p/(p+1)), so that it falls by more than the root of what
-- tol falls by, for p >= 1. Its steps say its order: they are proportional to tol^(1/(p+1)). Methods of low order need
-- too many of them for small tolerances.
local function tolerance(plugin, lines)
  local tols = plugin.order > 2 and { 1e-4, 1e-8, 1e-11 } or { 1e-3, 1e-5, 1e-7 }
  local fall = tols[1] / tols[2]
  for _, entry in ipairs(orders) do
    lines:at("the scene '%s', tol of %g to %g", entry[1], tols[1], tols[3])
    local list, steps, refused, estimates = {}, {}, nil, false
    for k, tol in ipairs(tols) do
      local X, report = scenes.advance(plugin, scenes[entry[1]], 0.5, 50, { tol = tol })
      if not X then refused = report break end
      list[k], steps[k] = X, report.taken
      estimates = estimates or report.error == report.error
    end
    if refused and entry[1] == "swing" then return lines:wrong("it runs: " .. refused, "see the message") end
    if refused then lines:note(("the scene '%s': %s"):format(entry[1], refused))
    else
      local first, last = entry[3] and 19 or 1, entry[3] and #list[1] - 1 or 18
      local loose = scenes.distance(list[1], list[3], first, last)
      local tight = scenes.distance(list[2], list[3], first, last)
      if not estimates then
        lines:value("no estimate")
        return lines:note("it estimates no error: tol is not its own, and it is tried with equal steps")
      elseif steps[1] == steps[2] and steps[2] == steps[3] then
        lines:wrong(("tol has no effect: %d steps with %g, %g and %g"):format(steps[1],
          tols[1], tols[2], tols[3]),
          "choose the step so that the error estimate meets s->tol; or drop HK_ADAPTIVE")
      else
        -- One that iterates to rounding takes no steps so long that its error is near a loose tolerance.
        local rounding = loose < tols[2] / 100
        local falls = tight < loose / math.sqrt(fall) or rounding
        lines:add(falls and loose > 0, ("the error falls with tol, by %g, m%s"):format(fall, entry[2]),
          ("%.2g to %.2g"):format(loose, tight), nil, "check the error estimate, and the weights and times of the stages")
        compare_with_another(lines, entry, list[3], 0.5, 3 * tight, first, last)
        -- A method of order p takes fall^(1/(p+1)) times as many steps; one of a lower order more.
        local asked = math.log(fall) / math.log(steps[2] / steps[1]) - 1
        if entry[1] == "swing" and steps[1] >= 8 then
          lines:add(asked > plugin.order - 1.3, ("order %d, by the number of its steps"):format(plugin.order),
            ("%.2f"):format(asked), nil, "the order is that of the solution that is kept")
        end
      end
    end
  end
end

-- ---- stability ----

-- Below its limit a motion of a linear oscillator is bounded (by 1/sqrt(1 - 0.97^2) = 4 for leapfrog); above, it grows
-- by the declared factor per step: in the number of steps for which this factor gives 1e20, it must grow by a hundred
-- at least, since the growing mode may be as small a part of the start as rounding, where a method of many steps begins
-- accurately.
local BOUNDED, TOTAL_GROWTH, LEAST_GROWTH, MOST_STEPS = 30, 1e20, 100, 50000

-- The growth of a perturbation over `steps` steps of h w.
local function growth(plugin, hw, damping, steps)
  local run = scenes.open(plugin, scenes.oscillator(hw, damping), { dt = 1 / 60 })
  if not run then return math.huge end
  local report = method.run(run, { h = 1 / 60, steps = steps })
  if report.status ~= 0 then return math.huge end
  return math.sqrt((report.X[4] - 1) ^ 2 + report.X[5] ^ 2 + report.X[6] ^ 2) / scenes.OFFSET
end

-- The largest h w up to which a stated factor is 1, to 1e-9; infinite: beyond 100.
local function limit_of(grows)
  local low, high = 0, nil
  local function stable(hw) return grows(hw) <= 1 + 1e-9 end
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

-- A limit against growth on both sides of it. measured(hw, steps) -> growth.
local function compare_limit(lines, what, grows, measured)
  local limit = limit_of(grows)
  local remedy = "the stated factor must be the spectral radius of one step"
  local function above(hw, text)
    local factor = grows(hw)
    local steps = factor > 1 and math.ceil(math.log(TOTAL_GROWTH) / math.log(factor)) or math.huge
    if steps > MOST_STEPS then return lines:note(text .. ": grows too slowly to be measured") end
    local figure = measured(hw, steps)
    lines:add(figure > LEAST_GROWTH or figure ~= figure, ("%s: growth in %d steps"):format(text, steps), figure, nil, remedy)
  end
  lines:at("a linear oscillator, %s", what)
  if limit == 0 then above(0.5, what .. ", no stable step is declared, h w = 0.5")
  elseif limit == math.huge then
    lines:most(what .. ", stable at any step: growth at h w = 50", measured(50, 300), BOUNDED, remedy)
  else
    lines:most(("%s, stable up to h w = %.4g: growth at 0.97 of it"):format(what, limit), measured(0.97 * limit, 300),
      BOUNDED, remedy)
    above(1.05 * limit, "and not beyond, at 1.05 of it")
  end
end

-- A factor is a number of 0 or more, and 1 where nothing acts.
local function is_a_factor(run, lines)
  for _, at in ipairs { { 0, 0 }, { 1e-9, 0 }, { 0.1, 0 }, { 0, 0.1 }, { 0.3, 0.1 }, { 1, 0 }, { 1, 1 }, { 0, 3 }, { 10, 0.1 },
    { 100, 200 } } do
    local factor = method.growth(run, at[1], at[2])
    if factor ~= factor or factor < 0 then
      lines:wrong(("`growth` is %g at h w = %g, h g = %g"):format(factor, at[1], at[2]),
        "NAN says that turning velocities are not stated, for hb other than 0; leave `growth` NULL where it is not known", false)
      return false
    end
    if at[1] < 1e-6 and at[2] == 0 and math.abs(factor - 1) > 1e-6 then
      lines:wrong(("`growth` is %g where nothing acts, h w = %g"):format(factor, at[1]),
        "x'' = 0 moves on: the largest factor of a step is 1", false)
      return false
    end
  end
  return true
end

local function growth_is_true(plugin, lines)
  local run, why = scenes.open(plugin, scenes.oscillator(0.1, 0))
  if not run then return lines:note("stability: " .. why) end
  if not is_a_factor(run, lines) then return end
  for _, damping in ipairs { 0, 0.1, 1 } do
    compare_limit(lines, ("damping ratio %g"):format(damping),
      function(hw) return method.growth(run, hw, 2 * damping * hw) end,
      function(hw, steps) return growth(plugin, hw, damping, steps) end)
  end
end

-- The radius in the plane (and of the velocity, over the fastest rate) after `steps` steps of 1/60 s, over the first.
local function turning_growth(plugin, hw, hg, hb, steps)
  local run = scenes.open(plugin, scenes.turning(hw, hg, hb), { dt = 1 / 60 })
  if not run then return nil end
  local start = method.state(run)
  local report = method.run(run, { h = 1 / 60, steps = steps })
  if report.status ~= 0 then return math.huge end
  local function size(X) return math.sqrt(X[1] ^ 2 + X[2] ^ 2 + (X[4] ^ 2 + X[5] ^ 2) / (30 * (hw + math.abs(hb))) ^ 2) end
  return size(report.X) / size(start)
end

local function turning_growth_is_true(plugin, lines)
  local run, why = scenes.open(plugin, scenes.turning(0.1, 0, 0.1))
  if not run then return lines:note("turning velocities: " .. why) end
  for _, at in ipairs { { 0.3, 0 }, { 0.7, 0.2 }, { 1.7, 0.5 }, { 2.4, 0.1 }, { 5, 3 } } do
    local still, slow = method.growth(run, at[1], at[2]), method.growth(run, at[1], at[2], 1e-15)
    if math.abs(math.max(still, 1) - math.max(slow, 1)) > 1e-6 * math.max(still, 1) then
      lines:wrong(("`growth` jumps where turning begins: %.6g with hb = 0 and %.6g with hb = 1e-15 at h w = %g, h g = %g"):format(
        still, slow, at[1], at[2]), "without turning it is that of an oscillator", false)
      break
    end
  end
  for _, at in ipairs { { 0, 0 }, { 0.2, 0.4 }, { 0.2, -0.4 } } do
    local damping, share = at[1], at[2] ~= 0 and at[2] or 1
    compare_limit(lines, ("turning at %g of h w, damping ratio %g"):format(share, damping),
      function(hw) return method.growth(run, hw, 2 * damping * hw, share * hw) end,
      function(hw, steps) return turning_growth(plugin, hw, 2 * damping * hw, share * hw, steps) end)
  end
end

local function implicit_is_stable(plugin, lines)
  lines:at("an oscillator, h w = 20, damping ratio 0.1")
  lines:most("claims HK_IMPLICIT: growth at h w = 20", growth(plugin, 20, 0.1, 300), BOUNDED,
    "a method that grows there is explicit; drop HK_IMPLICIT")
end

-- ---- reversibility, symplecticity ----

-- What returns, returns far within the error of a step, and no closer than the rounding of 120 steps of coordinates
-- of about 1 m.
local function reversibility(plugin, lines)
  lines:at("the scene 'swing' there and back, 60 steps each")
  local run = scenes.open(plugin, scenes.swing)
  local coarse, fine = scenes.advance(plugin, scenes.swing, T, 60), scenes.advance(plugin, scenes.swing, T, 120)
  if not (run and coarse and fine) then return end
  local start, n = method.state(run)
  local step_error = scenes.distance(coarse, fine, 1, 3 * n)
  local there = method.run(run, { h = T / 60, steps = 60 }).X
  for k = 3 * n + 1, 6 * n do there[k] = -there[k] end
  method.reset(run, "state")
  local back = method.run(run, { h = T / 60, steps = 60, X = there, t = 0 }).X
  lines:most("it returns when velocities are turned, as claimed, m", scenes.distance(start, back, 1, 3 * n),
    math.max(1e-3 * step_error, 120 * 2.2e-16), "drop HK_REVERSIBLE")
end

-- One step X -> X' of unit masses has the derivative M with M^T J M = J: by central differences of 1e-5 m, which have a
-- rounding and a solver's error of some 1e-6.
local function symplecticity(plugin, lines)
  local run = scenes.open(plugin, scenes.free)
  if not run then return end
  local X, n = method.state(run)
  local size, h, d, columns = 6 * n, 0.05, 1e-5, {}
  lines:at("three particles on two springs, h w = %.2g", h * math.sqrt(300))
  for k = 1, size do
    local ends = {}
    for side = 1, 2 do
      local from = { table.unpack(X) }
      from[k] = from[k] + (side == 1 and d or -d)
      method.reset(run, "state")
      local report = method.run(run, { h = h, X = from, t = 0 })
      if report.status ~= 0 then return end
      ends[side] = report.X
    end
    columns[k] = {}
    for r = 1, size do columns[k][r] = (ends[1][r] - ends[2][r]) / (2 * d) end
  end
  local worst = 0
  for a = 1, size do
    for b = 1, size do
      local sum = 0
      for r = 1, size / 2 do
        sum = sum + columns[a][r] * columns[b][r + size // 2] - columns[a][r + size // 2] * columns[b][r]
      end
      local expected = (b == a + size // 2 and 1 or 0) - (a == b + size // 2 and 1 or 0)
      worst = math.max(worst, math.abs(sum - expected))
    end
  end
  lines:most("a step keeps the symplectic form, as claimed", worst, 1e-3, "drop HK_SYMPLECTIC")
end

function accuracy.try(plugin, report)
  local function try(name, body) return report:try(name, function(lines) body(plugin, lines) end) end
  if plugin.adaptive then
    local _, values = try("accuracy", tolerance)
    if not values[1] then return end
  end
  try("order", order)
  if plugin.states_growth then try("growth", growth_is_true)
  else report:note("it states no growth factor: its steps are not chosen by stability") end
  if plugin.states_turning then try("growth where velocities turn", turning_growth_is_true) end
  if plugin.implicit then try("claims HK_IMPLICIT", implicit_is_stable) end
  if plugin.reversible then try("reversibility", reversibility) end
  if plugin.symplectic then try("symplecticity", symplecticity) end
end

return accuracy
