-- validation: the form of a problem of `hooke validate` (scripts/validation/README.md), and what problems have in common
-- in measuring: times of crossings, equilibria, roots over several runs. The mathematics of references is in closed.lua.
local validation = {}

local problem_fields = { title = "string", setup = "string", quantities = "table", space = "table", time = "table",
  order = "table", tolerance = "number", why = "string", noise = "number", quick = "table or boolean", forces = "table",
  together = "boolean", solve = "function", asks = "function", timeout = "number", space_label = "string", time_label = "string" }
local quantity_fields = { name = "string", unit = "string", reference = "number or function", source = "string",
  tolerance = "number", why = "string", scale = "number", order = "table", noise = "number" }
local quick_fields = { space = "table", time = "table", tolerance = "number" }
local order_fields = { space = "number", time = "number", within = "number", space_next = "number", time_next = "number" }

-- Without a line, which nobody knows: `return problem { ... }` leaves nothing on Lua's stack. The tool looks for it.
local function refuse(format, ...) error(format:format(...), 0) end

local function names_of(fields)
  local names = {}
  for name in pairs(fields) do names[#names + 1] = name end
  table.sort(names)
  return table.concat(names, ", ")
end

local function check_fields(what, given, fields)
  for name, value in pairs(given) do
    local kinds = fields[name]
    if not kinds then refuse("%s has no field '%s'; there are %s", what, name, names_of(fields)) end
    if not kinds:find(type(value), 1, true) then
      refuse("%s: %s: expected a %s, got a %s", what, name, kinds, type(value))
    end
  end
end

local function check_levels(what, list, rising)
  if not list then return end
  if #list < 3 then refuse("%s: at least three levels show an order; here are %d", what, #list) end
  for k, x in ipairs(list) do
    if type(x) ~= "number" or x <= 0 or x ~= x then refuse("%s: level %d is no number above 0", what, k) end
    local finer = k == 1 or (rising and x > list[k - 1] or not rising and x < list[k - 1])
    if not finer then
      refuse("%s: from coarse to fine, so the numbers %s: %g comes after %g", what, rising and "rise" or "fall", x,
        list[k - 1])
    end
  end
end

local function need(what, value, why)
  if value == nil then refuse("%s is missing: %s", what, why) end
end

local function check_quantity(p, q, k)
  local what = ("quantity %d"):format(k)
  if type(q) ~= "table" then refuse("%s: expected a table", what) end
  check_fields(what, q, quantity_fields)
  need(what .. ": name", q.name, "what the number is")
  what = ("quantity '%s'"):format(q.name)
  need(what .. ": reference", q.reference, "the known answer, a number or a function that computes it")
  need(what .. ": source", q.source, "where the reference comes from: paper and equation, or closed form")
  need(what .. ": tolerance", q.tolerance or p.tolerance, "what the extrapolated value has to reach, relative")
  need(what .. ": why", q.why or p.why, "where the tolerance comes from")
  if q.reference == 0 then need(what .. ": scale", q.scale, "errors are relative to it, since the reference is 0") end
  check_fields(what .. ": order", q.order or {}, order_fields)
end

local function check(p)
  if type(p) ~= "table" then refuse("a problem is a table: validation.problem { title = ... }") end
  check_fields("a problem", p, problem_fields)
  need("title", p.title, "one line for the page")
  need("solve", p.solve, "function(at) ... return value end, with at.n and at.h")
  need("space or time", p.space or p.time, "the levels, from coarse to fine: space = { 16, 32, 64 }, time = { h, h/2, h/4 }")
  need("quantities", p.quantities and p.quantities[1], "{ { name =, reference =, source = }, ... }")
  check_levels("space", p.space, true)
  check_levels("time", p.time, false)
  check_fields("order", p.order or {}, order_fields)
  if p.quick == true then refuse("quick: the levels of the short form, or false: it has none") end
  check_fields("quick", p.quick or {}, quick_fields)
  if p.quick then
    check_levels("quick: space", p.quick.space, true)
    check_levels("quick: time", p.quick.time, false)
  end
  local seen = {}
  for k, q in ipairs(p.quantities) do
    check_quantity(p, q, k)
    if seen[q.name] then refuse("quantity '%s' is there twice", q.name) end
    seen[q.name] = true
  end
  for force, params in pairs(p.forces or {}) do
    if type(force) ~= "string" or type(params) ~= "table" then
      refuse("forces: expected { springs = { \"edges\", \"k\" } }: a force, and the parameters that the scenes give it")
    end
  end
end

local function value_of(reference)
  if type(reference) == "function" then return reference() end
  return reference
end

-- Everything but the function, with the references computed.
local function described(p)
  local d = { quantities = {} }
  for key, value in pairs(p) do
    if key ~= "solve" and key ~= "quantities" and key ~= "asks" then d[key] = value end
  end
  d.asks = p.asks ~= nil
  for k, q in ipairs(p.quantities) do
    local copy = {}
    for key, value in pairs(q) do copy[key] = value end
    copy.reference = value_of(q.reference)
    if type(copy.reference) ~= "number" or copy.reference - copy.reference ~= 0 then
      error(("quantity '%s': its reference is no finite number"):format(q.name), 0)
    end
    copy.scale = q.scale or math.abs(copy.reference)
    copy.tolerance, copy.why = q.tolerance or p.tolerance, q.why or p.why
    if q.unit == "" then copy.unit = nil end
    copy.order = q.order or p.order or {}
    copy.noise = q.noise or p.noise or 1e-13
    d.quantities[k] = copy
  end
  return d
end

local function answers(p, at)
  local got = p.solve(at)
  if type(got) == "number" then got = { got } end
  if type(got) ~= "table" then error(("solve returned a %s, not its numbers"):format(type(got)), 0) end
  local list = {}
  for k, q in ipairs(p.quantities) do
    list[k] = got[k]
    if list[k] == nil then list[k] = got[q.name] end
    if type(list[k]) ~= "number" then
      error(("solve returned no number for the quantity '%s', number %d"):format(q.name, k), 0)
    end
  end
  return list
end

-- What a problem's file returns. `solve(at)` gets at.n (of `space`), at.h (of `time`) and at.quick, and returns the
-- quantities in their order, or by name; a problem with one quantity may return a number.
function validation.problem(p)
  check(p)
  return {
    describe = function() return described(p) end,
    solve = function(at) return answers(p, at) end,
    asks = p.asks,
  }
end

-- ---- measuring ----

-- The frame rate at which a fixed step of `h` seconds is exactly one frame, so that steps are as long as asked.
function validation.fps(h) return 1 / h end

-- Runs the scene step by step (a frame each) to its duration and calls look(state, t) after each; look may return true
-- to end. Returns the run.
function validation.each(scene, h, steps, look)
  local run
  for k = 0, steps do
    run = scene:run { to = k * h }
    if look(run:state(), k * h) then break end
  end
  return run
end

-- At t, the cubic with the values y0, y1 and the slopes s0, s1 at t0 and t1.
function validation.cubic(t, t0, y0, s0, t1, y1, s1)
  local u = (t - t0) / (t1 - t0)
  local w = 1 - u
  return w * w * (1 + 2 * u) * y0 + u * u * (3 - 2 * u) * y1 + u * w * (t1 - t0) * (w * s0 - u * s1)
end

-- The time in [t0, t1] at which that cubic vanishes; y0 and y1 differ in sign.
function validation.zero_between(t0, y0, s0, t1, y1, s1)
  local low, high = t0, t1
  for _ = 1, 60 do
    local middle = (low + high) / 2
    if (validation.cubic(middle, t0, y0, s0, t1, y1, s1) > 0) == (y0 > 0) then low = middle else high = middle end
  end
  return (low + high) / 2
end

-- A watcher of the zeros of a quantity: watch(t, y, slope) at every step, then watch.times. Between two steps it
-- interpolates by the cubic of both values and slopes (error O(h^4), below that of methods of order 2).
-- direction: 1 counts rising zeros only, -1 falling ones.
-- Asking for one that has not been is an error that says so.
local missing = { __index = function(times, k)
  error(("a quantity passed zero %d times, and the time of number %s is asked for: the run is too short, or it does not swing")
    :format(#times, k), 2)
end }

function validation.crossings(direction)
  local w = { times = setmetatable({}, missing) }
  local t0, y0, s0
  return setmetatable(w, { __call = function(_, t, y, slope)
    local crosses = y0 and y0 ~= 0 and (y0 > 0) ~= (y > 0)
    if crosses and (not direction or (y > y0) == (direction > 0)) then
      w.times[#w.times + 1] = validation.zero_between(t0, y0, s0, t, y, slope)
    end
    t0, y0, s0 = t, y, slope
    return #w.times
  end })
end

-- The place in [low, high] where f changes its sign, by bisection to `width`.
function validation.bisect(f, low, high, width)
  local at_low = f(low) > 0
  if (f(high) > 0) == at_low then
    error(("bisect: the function has the same sign at both ends, %g and %g"):format(low, high), 2)
  end
  while high - low > width do
    local middle = (low + high) / 2
    if (f(middle) > 0) == at_low then low = middle else high = middle end
  end
  return (low + high) / 2
end

-- Runs a damped scene until it rests: the largest speed of the particles at two looks, `every` seconds apart, is below
-- `speed` (m/s). An error where the scene's duration ends before. Returns the run.
function validation.rest(scene, every, speed, duration)
  local calm = 0
  for k = 1, math.floor(duration / every + 1e-9) do
    local run = scene:run { to = math.min(k * every, duration) }
    local state, fastest = run:state(), 0
    for _, id in ipairs(state:ids()) do
      local v = state:velocity(id)
      fastest = math.max(fastest, v[1] * v[1] + v[2] * v[2] + v[3] * v[3])
    end
    calm = fastest < speed * speed and calm + 1 or 0
    if calm == 2 then return run end
  end
  error(("the scene does not come to rest within %g s (speeds are not below %g m/s)"):format(duration, speed), 2)
end

return validation
