-- Products of a force's Jacobian of its own, for derivatives of runs: backwards, forwards, and of a bilinear form of its
-- blocks, against the blocks, each other and differences of the blocks.
local inspect = require("inspect")
local cases = require("common.check.force.cases")
local worst = require("common.check.force.worst")

local products = {}

local ROUNDING = 1e-12 -- of sums over some tens of numbers of size 1
local DIFFERENCES = 1e-6 -- those of smooth blocks are accurate to 1e-10 at the best step
local STEPS = { 1e-4, 1e-5, 1e-3, 1e-6 } -- relative to the length of the scene, or to a velocity of 1 m/s
local WISHES = { [0] = "as they are", [1] = "symmetric" }

local function at(case, text) return text and ("%s: %s"):format(case.name, text) or case.name end

-- Calls body(subject, case, x, v) at random states of the small cases.
local function at_random_states(plugin, lines, body)
  cases.each(plugin, lines, function(case) return case.few end, function(subject, case)
    for seed = 1, 2 do
      local x, v = cases.random_state(subject, case, seed)
      body(subject, case, x, v)
    end
  end, { exact = true })
end

local function waves(size, by)
  local list = {}
  for k = 1, size do list[k] = math.cos(by * k) end
  return list
end

-- A product of its own against the blocks: w.(J^T u) = u.(J w) for every w that is 1 once. Blocks that may leave
-- something out (HK_STIFFER_BLOCKS) are not those of the derivative.
local function transposed_is_of_the_blocks(plugin, lines)
  local found, adds, fails = worst.new(), worst.new(), nil
  at_random_states(plugin, lines, function(subject, case, x)
    local size, u = #x, {}
    for k = 1, size do u[k] = math.cos(1.3 * k) end
    local by_x, by_v, good = inspect.transposed(subject, u)
    if not by_x then return end
    if not good then fails = fails or case.name end
    local K, D = inspect.blocks(subject, 0)
    for m, by in ipairs { by_x, by_v } do
      local A = m == 1 and K or D
      local scale = math.max(worst.largest(A), 1e-300)
      for c = 1, size do
        local sum = by[c]
        for r = 1, size do sum = sum + A[(r - 1) * size + c] * u[r] end
        found:take(math.abs(sum) / scale, at(case, ("coordinate %d of (dF/d%s)^T u"):format(c, m == 1 and "x" or "v")))
      end
    end
    local x_on, v_on = inspect.transposed(subject, u, 1)
    local largest = math.max(1, worst.largest(by_x), worst.largest(by_v))
    for k = 1, size do
      adds:take(math.max(math.abs(x_on[k] - by_x[k]), math.abs(v_on[k] - by_v[k])) / largest, case.name)
    end
  end)
  lines:add(not fails, "its `transposed` is given at every state", nil, nil, "return HK_OK, or host->fail with the cause", fails)
  lines:most("u.(J w) = w.(J^T u) of its blocks and of its own product", found.figure, ROUNDING,
    "`transposed` adds J^T u, not K^T u = -J^T u, and leaves nothing out", found.where)
  lines:most("it adds to the products (x += ..., v += ...)", adds.figure, 1e-14 * 64,
    "write into->x[k] += ..., never =: forces share the lists", adds.where)
end

-- The change along dx and dv is -(K dx + D dv), and that along their opposites, of the same call, is the opposite.
local function along_is_of_the_blocks(plugin, lines)
  local found, adds, both, fails = worst.new(), worst.new(), worst.new(), nil
  at_random_states(plugin, lines, function(subject, case, x)
    local size = #x
    local dx, dv = waves(size, 1.3), waves(size, 0.7)
    local force, back, good = inspect.along(subject, dx, dv)
    if not good then fails = fails or case.name end
    local K, D = inspect.blocks(subject, 0)
    local scale = math.max(worst.largest(K), worst.largest(D), 1e-300)
    for r = 1, size do
      local sum = force[r]
      for c = 1, size do sum = sum + K[(r - 1) * size + c] * dx[c] + D[(r - 1) * size + c] * dv[c] end
      found:take(math.abs(sum) / scale, at(case, ("coordinate %d of dF"):format(r)))
      both:take(math.abs(force[r] + back[r]) / scale, case.name)
    end
    local on = inspect.along(subject, dx, dv, 1)
    for k = 1, size do adds:take(math.abs(on[k] - force[k]) / math.max(1, worst.largest(force)), case.name) end
  end)
  lines:add(not fails, "its `along` is given at every state", nil, nil, "return HK_OK, or host->fail with the cause", fails)
  lines:most("its change along a direction is J w of its blocks", found.figure, ROUNDING,
    "`along` adds dF/dx x + dF/dv v, not K x + D v, and leaves nothing out", found.where)
  lines:most("it goes along all directions of a call", both.figure, ROUNDING, "loop over directions[0 .. count - 1]", both.where)
  lines:most("it adds to the changes (force += ...)", adds.figure, 1e-14 * 64,
    "write directions[j].force[k] += ..., never =: forces share the lists", adds.where)
end

-- With changes of the parameters and the masses, too.
local function along_is_the_transposed(plugin, lines)
  local found = worst.new()
  at_random_states(plugin, lines, function(subject, case, x)
    local off, size = inspect.pair(subject, waves(#x, 0.9), waves(#x, 1.3), waves(#x, 0.7))
    found:take(off ~= off and math.huge or math.abs(off) / math.max(size, 1e-300), case.name)
  end)
  lines:most("u.(J w) = (J^T u).w of `along` and `transposed`, by parameters and masses as well", found.figure, ROUNDING,
    "what `transposed` gives by a number of the parameters or a mass, `along` takes along", found.where)
end

-- u.(by_x K + by_v D) w of the blocks as they are filled with that wish.
local BY_X, BY_V = 0.4, 1.7
local function form(subject, want, u, w)
  local K, D = inspect.blocks(subject, want)
  local size, sum = #u, 0
  for r = 1, size do
    for c = 1, size do
      local k = (r - 1) * size + c
      sum = sum + u[r] * (BY_X * K[k] + BY_V * D[k]) * w[c]
    end
  end
  return sum
end

-- The largest error of the derivatives by some coordinates, in parts of the largest of them.
local function error_of_form(subject, case, want, u, w, by, state)
  local key, list, most, text = state.key, state.list, 0, nil
  local scale = math.max(worst.largest(by), state.scale, 1e-300)
  for k = 1, #list, 2 do
    local least = math.huge
    for _, step in ipairs(STEPS) do
      local h, moved, value = step * (key == "x" and case.length or 1), table.move(list, 1, #list, 1, {}), {}
      for side = -1, 1, 2 do
        moved[k] = list[k] + side * h
        inspect.set(subject, { [key] = moved })
        value[side] = form(subject, want, u, w)
      end
      least = math.min(least, math.abs((value[1] - value[-1]) / (2 * h) - by[k]) / scale)
      if least <= 0.1 * DIFFERENCES then break end
    end
    inspect.set(subject, { [key] = list })
    if least > most then most, text = least, ("coordinate %d of the derivative by %s"):format(k, key) end
  end
  return most, text
end

local function bilinear_is_of_the_blocks(plugin, lines)
  local adds, fails, found = worst.new(), nil, { [0] = worst.new(), worst.new() }
  at_random_states(plugin, lines, function(subject, case, x, v)
    local u, w = waves(#x, 0.9), waves(#x, 1.3)
    for want = 0, 1 do
      local by_x, by_v, good = inspect.bilinear(subject, want, u, w, BY_X, BY_V)
      if not good then fails = fails or case.name end
      local scale = math.abs(form(subject, want, u, w)) / case.length
      for _, state in ipairs { { key = "x", list = x, by = by_x, scale = scale }, { key = "v", list = v, by = by_v, scale = scale } } do
        local figure, text = error_of_form(subject, case, want, u, w, state.by, state)
        found[want]:take(figure, at(case, text))
      end
      local x_on, v_on = inspect.bilinear(subject, want, u, w, BY_X, BY_V, 1)
      local largest = math.max(1, worst.largest(by_x), worst.largest(by_v))
      for k = 1, #x do adds:take(math.max(math.abs(x_on[k] - by_x[k]), math.abs(v_on[k] - by_v[k])) / largest, case.name) end
    end
  end)
  lines:add(not fails, "its `bilinear` is given at every state", nil, nil, "return HK_OK, or host->fail with the cause", fails)
  for want = 0, 1 do
    lines:most(("`bilinear` is the derivative of u.(K w + D w), blocks %s"):format(WISHES[want]), found[want].figure, DIFFERENCES,
      "it is that of the blocks as `jacobian` fills them with the same `want`", found[want].where)
  end
  lines:most("`bilinear` adds to the derivatives (x += ..., v += ...)", adds.figure, 1e-14 * 64,
    "write into->x[k] += ..., never =: forces share the lists", adds.where)
end

-- Blocks that may leave something out (HK_STIFFER_BLOCKS) are not those of the derivative.
function products.try(plugin, report)
  local exact = not plugin.stiffer_blocks
  if plugin.transposed and exact then
    report:try("its transposed product", function(l) transposed_is_of_the_blocks(plugin, l) end)
  end
  if plugin.along and exact then
    report:try("its change along a direction", function(l) along_is_of_the_blocks(plugin, l) end)
    if plugin.transposed then report:try("both of its products", function(l) along_is_the_transposed(plugin, l) end) end
  end
  if plugin.bilinear then
    report:try("the bilinear form of its blocks", function(l) bilinear_is_of_the_blocks(plugin, l) end)
  end
end

return products
