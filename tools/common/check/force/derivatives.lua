-- A force against its energy and its Jacobians, by central differences: the best of several steps counts, since a long
-- one has a truncation error and a short one a rounding error.
local inspect = require("inspect")
local cases = require("common.check.force.cases")
local products = require("common.check.force.products")
local worst = require("common.check.force.worst")

local derivatives = {}

-- Differences of smooth forces are accurate to 1e-10 at the best step; a wrong term has a relative error of some
-- percent.
local DIFFERENCES = 1e-6
local ROUNDING = 1e-12 -- of sums over some tens of numbers of size 1
local EPSILON = 2 ^ -52
local STEPS = { 1e-3, 1e-4, 1e-5, 1e-2, 1e-6, 1e-7 } -- relative to the length of the scene, the best ones first
local WANT_SYMMETRIC, WANT_DEFINITE = 1, 2

-- The least figure over the steps, and its text; it stops at the first that is fine.
local function best(length, figure_of)
  local least, text = math.huge, nil
  for _, step in ipairs(STEPS) do
    local figure, said = figure_of(step * length)
    if figure < least then least, text = figure, said end
    if least <= 0.1 * DIFFERENCES then break end
  end
  return least, text
end

local function at(case, text) return text and ("%s: %s"):format(case.name, text) or case.name end

-- Calls body(subject, case, x, v) at random states of all cases.
local function at_random_states(plugin, lines, body, wanted)
  cases.each(plugin, lines, wanted, function(subject, case)
    for seed = 1, case.few and 2 or 1 do
      local x, v = cases.random_state(subject, case, seed)
      body(subject, case, x, v)
    end
  end, { exact = true })
end

-- ---- energy ----

local function gradient_of(subject, case, F)
  local E = math.abs(inspect.energy(subject))
  return best(case.length, function(h)
    local slope = inspect.gradient(subject, "x", h)
    for k = 1, #slope do slope[k] = -slope[k] end
    return worst.difference(F, slope, 8 * EPSILON * E / h)
  end)
end

local function velocities_do_not_matter(lines, moved)
  lines:most("its energy does not depend on velocities", moved.figure, 0,
    "energy is that of the positions; what damping takes goes to `power`", moved.where)
end

local function force_is_minus_the_gradient(plugin, lines)
  local found, moved = worst.new(), worst.new()
  at_random_states(plugin, lines, function(subject, case)
    local F = inspect.force(subject, 0)
    local figure, text = gradient_of(subject, case, F)
    found:take(figure, at(case, text))
    moved:take(worst.largest(inspect.gradient(subject, "v", 0.1)) > 0 and 1 or 0, case.name)
  end)
  lines:most("force is minus the gradient of its energy", found.figure, DIFFERENCES,
    "compare the formulas of `add` and `energy`; a force with another part than that has HK_POWER", found.where)
  velocities_do_not_matter(lines, moved)
end

-- F.v + dE/dt along v - power, over the sum of |F_i v_i|.
local function power_error(subject, case, x, v)
  local F, power = inspect.force(subject, 0, 0)
  local E, work, scale = math.abs(inspect.energy(subject)), 0, 0
  for k = 1, #F do
    work = work + F[k] * v[k]
    scale = scale + math.abs(F[k] * v[k])
  end
  return best(case.length, function(h)
    local function moved(step)
      local to = {}
      for k = 1, #x do to[k] = x[k] + step * v[k] end
      inspect.set(subject, { x = to })
      return inspect.energy(subject)
    end
    local rate = (moved(h) - moved(-h)) / (2 * h)
    inspect.set(subject, { x = x })
    local off = math.abs(work + rate - power) - 8 * EPSILON * (E / h + scale)
    if off ~= off then return math.huge end
    return scale > 0 and math.max(0, off) / scale or off > 0 and off or 0,
      ("power %.6g W, expected %.6g W"):format(power, work + rate)
  end)
end

local function power_is_of_the_rest(plugin, lines)
  local found, moved = worst.new(), worst.new()
  at_random_states(plugin, lines, function(subject, case, x, v)
    local figure, text = power_error(subject, case, x, v)
    found:take(figure, at(case, text))
    moved:take(worst.largest(inspect.gradient(subject, "v", 0.1)) > 0 and 1 or 0, case.name)
  end)
  if plugin.energy then velocities_do_not_matter(lines, moved) end
  lines:most("its power is that of the force less the gradient of its energy", found.figure, DIFFERENCES,
    "add (F + dE/dx).v to *view->power, negative for what damps", found.where)
end

-- ---- Jacobians ----

local function names_fitting_blocks(lines, subject)
  local names, why = inspect.pattern(subject)
  local n = inspect.state(subject).n
  if not names then
    return lines:wrong("its pattern names other blocks the second time: " .. (why or ""),
      "name the same blocks in the same order until `update` reports a change")
  end
  for k = 1, #names do
    if names[k] >= n then
      return lines:wrong(("its pattern names particle %d of %d"):format(names[k] + 1, n), "name indices below view->n")
    end
  end
  return true
end

-- Whether A + 1e-9 scale I has a Cholesky factor: no eigenvalue of the symmetric part is below -1e-9 scale.
local function definite(A, size, scale)
  local shift, factor = 1e-9 * scale, {}
  for r = 1, size do
    for k = 1, r do
      local sum = (A[(r - 1) * size + k] + A[(k - 1) * size + r]) / 2 + (r == k and shift or 0)
      for q = 1, k - 1 do sum = sum - factor[(r - 1) * size + q] * factor[(k - 1) * size + q] end
      if r == k and (sum < 0 or sum ~= sum) then return false end
      local pivot = factor[(k - 1) * size + k]
      factor[(r - 1) * size + k] = r == k and math.sqrt(sum) or pivot > 0 and sum / pivot or 0
    end
  end
  return true
end
derivatives.definite = definite

local function jacobian_error(subject, A, length, z)
  local size = #inspect.state(subject).x
  local F = worst.largest(inspect.force(subject, 0))
  return best(length, function(h)
    local slopes = inspect.slopes(subject, z or "x", h)
    return worst.matrix_difference(A, slopes, size, 16 * EPSILON * F / h)
  end)
end

-- 1 where the block A is softer than the differences in some direction, by more than a millionth of its size; for
-- HK_STIFFER_BLOCKS.
local function softness(subject, A, length, z)
  local size, most = #inspect.state(subject).x, worst.largest(A)
  return best(length, function(h)
    local slopes, more = inspect.slopes(subject, z or "x", h), {}
    for k = 1, size * size do more[k] = A[k] - slopes[k] end
    return definite(more, size, 1e3 * most) and 0 or 1, "softer in some direction"
  end)
end

-- At rest: how a damping turns with the positions is no part of what is claimed.
local function softness_at_rest(subject, length, v)
  local rest = {}
  for k = 1, #v do rest[k] = 0 end
  inspect.set(subject, { v = rest })
  local K = inspect.blocks(subject, 0)
  local figure, text = softness(subject, K, length)
  inspect.set(subject, { v = v })
  return figure, text
end

-- Pairs and clouds are small enough for full matrices.
local function jacobians_are_the_derivatives(plugin, lines)
  local K_found, D_found, adds, stale, fine = worst.new(), worst.new(), worst.new(), nil, true
  at_random_states(plugin, lines, function(subject, case, x, v)
    if not fine then return end
    fine = names_fitting_blocks(lines, subject)
    if not fine then return end
    local K, D, good = inspect.blocks(subject, 0)
    if not good then
      fine = false
      return lines:wrong("its `jacobian` fails at a random state", "return HK_OK, or host->fail with the cause")
    end
    local stiffer, figure, text = plugin.stiffer_blocks, nil, nil
    if stiffer then figure, text = softness_at_rest(subject, case.length, v) end
    if not stiffer then figure, text = jacobian_error(subject, K, case.length) end
    K_found:take(figure, at(case, text))
    figure, text = (stiffer and softness or jacobian_error)(subject, D, 1, "v")
    D_found:take(figure, at(case, text))
    local K_on, D_on = inspect.blocks(subject, 0, 1)
    local size = math.max(1, worst.largest(K), worst.largest(D))
    for k = 1, #K do adds:take(math.max(math.abs(K_on[k] - K[k]), math.abs(D_on[k] - D[k])) / size, case.name) end
    -- The last evaluation was elsewhere.
    local elsewhere = {}
    for k = 1, #x do elsewhere[k] = x[k] + 0.1 * case.length * math.sin(k) end
    inspect.set(subject, { x = elsewhere })
    inspect.force(subject, 0)
    inspect.energy(subject)
    inspect.set(subject, { x = x })
    local K_now, D_now = inspect.blocks(subject, 0)
    if worst.difference(K_now, K) > ROUNDING or worst.difference(D_now, D) > ROUNDING then stale = stale or case.name end
  end)
  if not fine then return end
  local claims = plugin.stiffer_blocks
  lines:most(claims and "K is nowhere softer than -dF/dx at rest, as claimed" or "K = -dF/dx (central differences)",
    K_found.figure, DIFFERENCES,
    "K is minus the derivative of F; look at the signs and at the terms across the direction", K_found.where)
  lines:most(claims and "D is nowhere softer than -dF/dv, as claimed" or "D = -dF/dv (central differences)", D_found.figure, DIFFERENCES,
    "D is minus the derivative of F with respect to the velocities", D_found.where)
  lines:most("it adds to the blocks (K += ..., D += ...)", adds.figure, 1e-14 * 64, -- a block has up to 64 summands here
    "write K[9*slot + q] += ..., never =: forces share the blocks", adds.where)
  lines:add(not stale, "its Jacobian is that of the state it is given" .. (stale and ": it is that of the last evaluation"
    or ""), nil, nil, "compute it from view->x and view->v; keep nothing from `add`", stale)
end

local function asymmetry(A, size)
  local most, off = worst.largest(A), 0
  for r = 1, size do
    for k = 1, r - 1 do off = math.max(off, math.abs(A[(r - 1) * size + k] - A[(k - 1) * size + r])) end
  end
  return most > 0 and off / most or 0
end

local function symmetric_as_claimed(plugin, lines)
  local claimed, wanted, left_out = worst.new(), worst.new(), worst.new()
  at_random_states(plugin, lines, function(subject, case, _, v)
    local size = #v
    local K, D = inspect.blocks(subject, 0)
    claimed:take(math.max(asymmetry(K, size), asymmetry(D, size)), case.name)
    local K_wanted, D_wanted = inspect.blocks(subject, WANT_SYMMETRIC)
    if plugin.symmetric or plugin.offers_symmetric then
      wanted:take(math.max(asymmetry(K_wanted, size), asymmetry(D_wanted, size)), case.name)
    end
    -- Where the exact blocks are symmetric nothing is to be left out; at rest those of damped elements are.
    local rest = {}
    for k = 1, size do rest[k] = 0 end
    for _, at_v in ipairs { v, rest } do
      inspect.set(subject, { v = at_v })
      local A, B = { inspect.blocks(subject, 0) }, { inspect.blocks(subject, WANT_SYMMETRIC) }
      for m = 1, 2 do
        if asymmetry(A[m], size) <= ROUNDING then
          local figure, text = worst.matrix_difference(B[m], A[m], size)
          left_out:take(figure, at(case, (m == 1 and "K, " or "D, ") .. (text or "")))
        end
      end
    end
  end, function(case) return case.few end)
  if plugin.symmetric then
    lines:most("K and D are symmetric, as claimed", claimed.figure, ROUNDING,
      "drop HK_SYMMETRIC_JACOBIAN; HK_OFFERS_SYMMETRIC says that the unsymmetric terms can be left out", claimed.where)
  end
  if plugin.offers_symmetric then
    lines:most("K and D are symmetric when it is asked for", wanted.figure, ROUNDING,
      "with HK_WANT_SYMMETRIC leave out the unsymmetric terms of dF/dx", wanted.where)
  end
  lines:most("HK_WANT_SYMMETRIC leaves out unsymmetric terms and nothing else", left_out.figure, 1e-9,
    "symmetric blocks are the same with that flag", left_out.where)
end

-- A force may project the blocks of its elements, or leave out the terms that can be negative (Gauss and Newton): of one
-- element both are the block itself, or less, where that is definite.
local function definite_as_offered(plugin, lines)
  local negative, off, more
  at_random_states(plugin, lines, function(subject, case, _, v)
    local size, want = #v, WANT_SYMMETRIC + WANT_DEFINITE
    local exact, asked = { inspect.blocks(subject, WANT_SYMMETRIC) }, { inspect.blocks(subject, want) }
    local unasked = { inspect.blocks(subject, 0) }
    for m, name in ipairs { "K", "D" } do
      local place = name .. ", " .. case.name
      local was, is, rest = worst.largest(unasked[m]), worst.largest(asked[m]), {}
      local finite = is - is == 0
      if not finite or is > 10 * was or is < 1e-6 * was then off = off or place end
      if finite and not definite(asked[m], size, is) then negative = negative or place end
      if finite and size == 6 and definite(exact[m], size, was) then
        for k = 1, size * size do rest[k] = exact[m][k] - asked[m][k] end
        if not definite(rest, size, 10 * was) then more = more or place end
      end
    end
  end)
  lines:add(not negative, "K and D have no negative eigenvalue when it is asked for", "above -1e-9 of the largest", nil,
    "with HK_WANT_DEFINITE project each element's block on what is not negative", negative or false)
  lines:add(not off, "the blocks under HK_WANT_DEFINITE are of the size of the exact ones", nil, nil,
    "project the blocks, do not replace them; fill them as without the flag", off or false)
  lines:add(not more, "HK_WANT_DEFINITE leaves a block as it is that is definite", nil, nil,
    "take off negative eigenvalues and nothing else", more or false)
end

-- Without a Jacobian: who refuses the force is asked of the methods themselves.
local function methods_that_need_one(plugin, lines)
  local case, refuse = nil, {}
  for _, c in ipairs(cases.list(plugin)) do case = case or (c.setting and c.few and c) end
  for _, method in ipairs(case and (hooke.catalogue()) or {}) do
    if method.kind == "integrator" then
      lines:at("%s, with the method %s", case.name, method.name)
      local run, why = cases.open(plugin, case, { integrator = method.name, to = 1 / 60 })
      if not run and why:find("no Jacobian", 1, true) then refuse[#refuse + 1] = method.name end
    end
  end
  lines:note(("it has no Jacobian: %s refuse%s it, other methods take it as it is"):format(
    #refuse > 0 and table.concat(refuse, ", ") or "no method", #refuse > 1 and "" or "s"))
end

function derivatives.try(plugin, report)
  if plugin.energy and not plugin.power then
    report:try("force is minus the gradient of its energy", function(l) force_is_minus_the_gradient(plugin, l) end)
  elseif plugin.power then
    report:try("its power", function(l) power_is_of_the_rest(plugin, l) end)
  else
    report:note("it has neither energy nor power: all of F.v counts as work done on the scene")
  end
  if not plugin.jacobian then
    if not report.only then report:try(nil, function(l) methods_that_need_one(plugin, l) end) end
    return
  end
  report:try("its Jacobian", function(l) jacobians_are_the_derivatives(plugin, l) end)
  products.try(plugin, report)
  report:try("the symmetry of its Jacobian", function(l) symmetric_as_claimed(plugin, l) end)
  if plugin.offers_definite then
    report:try("its definite blocks", function(l) definite_as_offered(plugin, l) end)
  end
end

return derivatives
