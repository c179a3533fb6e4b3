-- What a force claims by its flags: what it depends on, at any time, and what it keeps.
local inspect = require("inspect")
local cases = require("common.check.force.cases")
local worst = require("common.check.force.worst")

local claims = {}

local ROUNDING = 1e-12 -- of sums over some tens of numbers of size 1
-- s: close to the start, at round times and not, and long after any run
local TIMES = { 1e-3, 0.1, 0.37, 0.5, 1, 2, math.pi, 7.3, 12, 60, 99.9, 1e3, 4321.1, 1e6 }

local function momenta(subject, x)
  local F = inspect.force(subject, 0)
  local sum, force, moment = { 0, 0, 0, 0, 0, 0 }, 0, 0
  for i = 0, #F // 3 - 1 do
    for c = 0, 2 do
      local d, e = (c + 1) % 3, (c + 2) % 3
      local xd, xe, Fd, Fe = x[3 * i + d + 1], x[3 * i + e + 1], F[3 * i + d + 1], F[3 * i + e + 1]
      sum[c + 1] = sum[c + 1] + F[3 * i + c + 1]
      sum[c + 4] = sum[c + 4] + xd * Fe - xe * Fd
      force = force + math.abs(F[3 * i + c + 1])
      moment = moment + math.abs(xd * Fe) + math.abs(xe * Fd)
    end
  end
  local p = math.max(math.abs(sum[1]), math.abs(sum[2]), math.abs(sum[3]))
  local L = math.max(math.abs(sum[4]), math.abs(sum[5]), math.abs(sum[6]))
  return force > 0 and p / force or 0, moment > 0 and L / moment or 0
end

local function keeps_momenta(plugin, lines)
  local linear, angular = worst.new(), worst.new()
  cases.each(plugin, lines, nil, function(subject, case)
    for seed = 1, 2 do
      local x = cases.random_state(subject, case, seed)
      local p, L = momenta(subject, x)
      linear:take(p, case.name)
      -- A pair close together far from the origin loses digits in x; its moment is known as well as x is.
      angular:take(L, case.name)
    end
  end, { exact = true })
  if plugin.momentum then
    lines:most("momentum is kept, as claimed", linear.figure, ROUNDING,
      "the forces of a tuple must sum to zero; or drop HK_CONSERVES_MOMENTUM", linear.where)
  end
  if plugin.angular_momentum then
    lines:most("angular momentum is kept, as claimed", angular.figure, ROUNDING,
      "the forces of a pair must be along their distance; or drop HK_CONSERVES_ANGULAR_MOMENTUM", angular.where)
  end
end

-- The states in which a dependence is looked for: one near the start, one with large velocities, one with large
-- displacements.
local function states(subject, case)
  local x, v = cases.random_state(subject, case, 1)
  local fast, wide = {}, {}
  for k = 1, #x do fast[k], wide[k] = 30 * v[k], 3 * x[k] end
  return { { x, v }, { x, fast }, { wide, v } }
end

local flags = { x = "HK_DEPENDS_ON_X", v = "HK_DEPENDS_ON_V", t = "HK_DEPENDS_ON_T", y = "HK_DEPENDS_ON_CHANNELS" }
local quantities = { x = "positions", v = "velocities", t = "time", y = "channels" }

-- What else `changed` may be tried with: for t all times, for arrays others of the same size.
local function others(what, state)
  local list = {}
  if what == "t" then
    for _, t in ipairs(TIMES) do list[#list + 1] = { { t = t }, ("t = %g s"):format(t) } end
    return list
  end
  for _, factor in ipairs { 0.1, 3 } do
    local array = {}
    for k = 1, #state[what] do array[k] = state[what][k] + factor * math.sin(k) end
    list[#list + 1] = { { [what] = array }, ("%s changed by %g"):format(quantities[what], factor) }
  end
  return list
end

local function depends_as_claimed(plugin, lines)
  local told = {}
  cases.each(plugin, lines, nil, function(subject, case)
    for _, pair in ipairs(states(subject, case)) do
      inspect.set(subject, { x = pair[1], v = pair[2] })
      local state = inspect.state(subject)
      local F, power = inspect.force(subject, 0, 0)
      local E, dy = inspect.energy(subject), inspect.rates(subject)
      for what in pairs(quantities) do
        local claimed = plugin["on_" .. what]
        for _, other in ipairs(claimed and {} or told[what] and {} or others(what, state)) do
          inspect.set(subject, other[1])
          local now, power_now = inspect.force(subject, 0, 0)
          local off, text = worst.difference(now, F)
          local by = what == "t" and plugin.energy and inspect.energy(subject) ~= E
          if what == "t" and not plugin.power and power_now ~= power then off = 1 end
          if (off > 0 or by) and not told[what] then
            told[what] = true
            lines:wrong(("it does not depend on %s, as claimed: %s with %s"):format(quantities[what], text or "the energy changes",
              other[2]), ("claim %s; without it methods skip evaluations"):format(flags[what]))
          end
        end
        inspect.set(subject, state)
      end
      if dy and not plugin.on_t and not told.rates then
        inspect.set(subject, { t = 7.3 })
        if worst.difference(inspect.rates(subject), dy) > 0 then
          told.rates = true
          lines:wrong("its rates depend on time and it does not claim so", "claim HK_DEPENDS_ON_T")
        end
        inspect.set(subject, state)
      end
    end
  end)
  for what, quantity in pairs(quantities) do
    if not plugin["on_" .. what] and not told[what] then
      lines:add(true, ("it does not depend on %s, as claimed"):format(quantity))
    end
  end
end

local function rates_are_added(plugin, lines)
  local adds = worst.new()
  cases.each(plugin, lines, function(case) return case.few end, function(subject, case)
    cases.random_state(subject, case, 1)
    local dy, onto = inspect.rates(subject), inspect.rates(subject, 1)
    for k = 1, #(dy or {}) do adds:take(math.abs(onto[k] - dy[k] - 1) / math.max(1, math.abs(dy[k])), case.name) end
  end)
  lines:most("it adds to the rates of the channels (dy += ...)", adds.figure, 1e-14, "write dy[...] += ...", adds.where)
end

function claims.try(plugin, report)
  report:try("what it depends on", function(l) depends_as_claimed(plugin, l) end)
  if plugin.momentum or plugin.angular_momentum then
    report:try("momentum", function(l) keeps_momenta(plugin, l) end)
  end
  if plugin.has.rates then report:try("its rates", function(l) rates_are_added(plugin, l) end) end
end

return claims
