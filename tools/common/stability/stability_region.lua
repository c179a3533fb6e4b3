-- Stability on the linear oscillator x'' = -g x' - w^2 x: the measured stability of a method's steps, compared with the
-- growth that its plugin states and with theory.
--
-- Growth is measured on runs of hooke itself (region_scene.lua: hundreds of oscillators in one). A step is a linear
-- map, so positions and velocities obey a linear recurrence, of order 2 for a one-step method and more with a history,
-- whose growth is that of the step (recurrence.lua).
--
-- The largest stable step is the first h w at which a motion grows by more than 1e-10 per step (apart from rounding):
-- it is searched in steps of 4 % and then refined. The search begins at h max(w, g) = 0.05, where methods that are
-- stable nowhere grow by h^4 w^4/8 = 8e-7; a limit below that counts as none.
local amplification = require("amplification")
local json = require("cjson").new()
local oscillator_theory = require("common.stability.oscillator_theory")
local process = require("process")
local recurrence = require("common.stability.recurrence")
local case_process = require("common.run.case_process")

json.encode_invalid_numbers(true)
json.decode_invalid_numbers(true)

local stability_region = {}

stability_region.ratios = oscillator_theory.ratios

local steps = 26

-- ---- growth of a method ----

-- The plugin with algebraic tolerances at rounding level, for implicit methods.
local function with_small_tolerance(plugin)
  for _, param in ipairs(plugin.params) do
    if param.name == "tolerance" and param.initial[1] > 0 then return plugin.name .. ":tolerance=1e-13" end
  end
  return plugin.name
end

-- The sequences of positions and scaled velocities of each point's two oscillators.
local function sequences_of(list, points)
  local all = {}
  for k = 1, #points do all[k] = { {}, {}, {}, {} } end
  for step = 2, #list do
    local n = math.tointeger(string.unpack("d", list[step]))
    for k, point in ipairs(points) do
      for start = 0, 1 do
        local at = 2 + n + 3 * (2 * k - 1 + start) -- number of doubles before the oscillator's x
        all[k][1 + start][step - 1] = string.unpack("d", list[step], 1 + 8 * at)
        all[k][3 + start][step - 1] = string.unpack("d", list[step], 1 + 8 * (at + 3 * n))
          / math.max(1, point[1], point[2])
      end
    end
  end
  return all
end

-- Of a run that has diverged, the growth of each half of its points: a point that diverges by itself grows without end.
local function halves(plugin, points)
  if #points == 1 then return { math.huge } end
  local middle, growth = #points // 2, {}
  for _, half in ipairs { { 1, middle }, { middle + 1, #points } } do
    local list, why = stability_region.measure(plugin, table.move(points, half[1], half[2], 1, {}))
    if not list then return nil, why end
    table.move(list, 1, #list, #growth + 1, growth)
  end
  return growth
end

-- Measured growth factors at points {hw, hg}; nil and the reason when the run failed. `false` in place of a number: the
-- method is not linear at this point, or changes its step.
function stability_region.measure(plugin, points)
  local text = {}
  for k, point in ipairs(points) do text[k] = ("%.17g %.17g"):format(point[1], point[2]) end
  local result, list = case_process.execute { scene = hooke.folder .. "/common/stability/region_scene.lua",
    integrator = with_small_tolerance(plugin), params = { points = table.concat(text, " "), steps = steps }, frames = true }
  if result.failed and result.verdict == "diverged" then return halves(plugin, points) end
  if result.failed then return nil, result.failed end
  if result.steps ~= steps then return nil, ("it took %d steps where %d were given"):format(result.steps, steps) end
  local growth = {}
  for k, sequences in ipairs(sequences_of(list, points)) do
    growth[k] = recurrence.growth_of(sequences) or false
  end
  return growth
end

-- The function (hw, hg) -> growth that the plugin states; nil when it states none.
function stability_region.stated(plugin) return amplification.open(plugin.path) end

-- ---- the largest stable h w ----

local first_rung = 0.05

-- The search values of h max(w, g), in blocks: few run together, since a motion far beyond its limit makes the whole
-- run diverge.
local function search_values()
  local list, x = { {} }, first_rung
  while x < 1e4 do
    local block = list[#list]
    if #block == 12 then
      block = {}
      list[#list + 1] = block
    end
    block[#block + 1] = x
    x = x * (x < 50 and 1.04 or 2)
  end
  return list
end

local blocks = search_values()

local function scaled(block, ratio)
  local list = {}
  for k, x in ipairs(block) do list[k] = x / math.max(1, 2 * ratio) end
  return list
end

-- Whether the growth exceeds 1 by more than the rounding errors of a double root and of a matrix with entries (h w)^2.
local function grows(growth, point)
  local z = math.max(point[1], point[2])
  return growth > 1 + 1e-10 + 1e-15 * z * z
end

local function between(bracket, count)
  local list = {}
  for k = 1, count do list[k] = bracket.low * (bracket.high / bracket.low) ^ (k / count) end
  return list
end

-- Measures the values values_of(search) of each search, and narrows its bracket to the first value that grows.
-- measure(points) -> growth.
local function narrow(searches, values_of, measure)
  local points, owner = {}, {}
  for _, search in ipairs(searches) do
    for _, hw in ipairs(values_of(search)) do
      points[#points + 1] = { hw, 2 * search.ratio * hw }
      owner[#owner + 1] = search
    end
  end
  local growth, why = measure(points)
  if not growth then return nil, why end
  local done = {}
  for k, point in ipairs(points) do
    local search = owner[k]
    if not done[search] then
      if growth[k] == false then return nil, "no fixed linear step" end
      if grows(growth[k], point) then
        search.high, done[search] = point[1], true
      else
        search.low = point[1]
      end
    end
  end
  return true
end

-- The limits of h w at the ratios, in their order: math.huge: stable at any step; 0: at none. Or nil and the reason.
function stability_region.limits(measure)
  local searches = {}
  for k, ratio in ipairs(stability_region.ratios) do searches[k] = { ratio = ratio, low = 0 } end
  for _, block in ipairs(blocks) do
    local open = {}
    for _, search in ipairs(searches) do
      if not search.high then open[#open + 1] = search end
    end
    if #open == 0 then break end
    local fine, why = narrow(open, function(search) return scaled(block, search.ratio) end, measure)
    if not fine then return nil, why end
  end
  local open = {}
  for _, search in ipairs(searches) do
    if search.high and search.low > 0 then open[#open + 1] = search end
  end
  for _ = 1, #open > 0 and 3 or 0 do
    local fine, why = narrow(open, function(search) return between(search, 16) end, measure)
    if not fine then return nil, why end
  end
  local limits = {}
  for k, search in ipairs(searches) do limits[k] = search.high and search.low or math.huge end
  return limits
end

function stability_region.measured_limits(plugin)
  return stability_region.limits(function(points) return stability_region.measure(plugin, points) end)
end

-- The same search on a function (hw, hg) -> growth.
function stability_region.limits_of(growth)
  return stability_region.limits(function(points)
    local list = {}
    for k, point in ipairs(points) do list[k] = growth(point[1], point[2]) end
    return list
  end)
end

-- ---- all methods ----

local function work(plugin, fd)
  local answer = { pcall(stability_region.measured_limits, plugin) }
  if answer[1] then answer = { limits = answer[2], why = answer[3] } else answer = { why = tostring(answer[2]) } end
  process.write(fd, json.encode(answer))
  process.exit(0)
end

local function start(plugin)
  local pid, fd = process.fork()
  if pid == 0 then work(plugin, fd) end
  return { plugin = plugin, pid = pid, fd = fd, text = "" }
end

local function row_of(job)
  process.close(job.fd)
  process.wait(job.pid)
  local plugin, fine, answer = job.plugin, pcall(json.decode, job.text)
  if not fine then answer = { why = "the process that measured it crashed" } end
  local stated = stability_region.stated(plugin)
  return { plugin = plugin, measured = answer.limits, why = answer.why,
    theory = oscillator_theory.limits(plugin.name, stability_region.limits_of),
    stated = stated and stability_region.limits_of(stated) }
end

-- Measures the plugins, `jobs` at a time, each in a process of its own: rows { plugin, measured, why (it is nil), stated,
-- theory } of limits in the order of the ratios. done(plugin) as each ends.
function stability_region.all(plugins, jobs, done, tick)
  local running, count, next, rows = {}, 0, 1, {}
  while next <= #plugins or count > 0 do
    while count < jobs and plugins[next] do
      local job = start(plugins[next])
      job.place = next
      running[job.fd], count, next = job, count + 1, next + 1
    end
    local fds = {}
    for fd in pairs(running) do fds[#fds + 1] = fd end
    for fd in pairs(process.ready(fds, 0.1)) do
      local job, text = running[fd], process.read(fd)
      job.text = job.text .. text
      if text == "" then
        rows[job.place], running[fd], count = row_of(job), nil, count - 1
        done(job.plugin)
      end
    end
    tick()
  end
  return rows
end

-- ---- evaluation ----

local function apart(a, b)
  if a == b then return 0 end
  return a < math.huge and b < math.huge and b > 0 and math.abs(a / b - 1) or math.huge
end

local function useful(limit, k) return limit * math.max(1, 2 * stability_region.ratios[k]) < first_rung and 0 or limit end

-- The largest relative difference of two lists of limits, and the number of limits compared; nil: none in common.
function stability_region.difference(a, b)
  local worst, count = 0, 0
  for k = 1, #stability_region.ratios do
    if a and b and a[k] and b[k] then
      worst, count = math.max(worst, apart(useful(a[k], k), useful(b[k], k))), count + 1
    end
  end
  if count > 0 then return worst, count end
end

-- The search is precise to 1e-5, and where the growth begins quadratically, the threshold of 1e-10 per step has an
-- error of the same size.
stability_region.precision = 1e-4

local function agreement(row, list)
  local worst, count = stability_region.difference(row.measured, list)
  if not worst then return "-" end
  local of = count < #stability_region.ratios and (" (%d)"):format(count) or ""
  if worst <= stability_region.precision then return "same" .. of end
  return worst == math.huge and "DIFFERS" .. of or ("off by %.2g%s"):format(worst, of)
end

local function figure(x) return x == math.huge and "any" or x == 0 and "none" or ("%.4g"):format(x) end

function stability_region.table(rows)
  local lines = { "largest stable h w on x'' = -g x' - w^2 x, measured on hooke's own steps; columns: xi = g/(2 w)\n" }
  local head = { ("%-18s"):format("") }
  for _, ratio in ipairs(stability_region.ratios) do head[#head + 1] = (" %8s"):format(("%g"):format(ratio)) end
  lines[2] = table.concat(head) .. "   as stated      theory"
  for _, row in ipairs(rows) do
    local cells = { ("%-18s"):format(row.plugin.name) }
    for k = 1, #stability_region.ratios do cells[k + 1] = (" %8s"):format(row.measured and figure(row.measured[k]) or "-") end
    lines[#lines + 1] = table.concat(cells) .. ("   %-14s %s"):format(agreement(row, row.stated),
      agreement(row, row.theory)) .. (row.why and "   " .. row.why or "")
  end
  lines[#lines + 1] = "\nany: stable at every step; none: no step worth the name (h max(w, g) below 0.05)"
  return table.concat(lines, "\n")
end

-- The methods whose steps are less stable than their plugin states.
function stability_region.overstated(rows)
  local list = {}
  for _, row in ipairs(rows) do
    for k = 1, row.measured and row.stated and #stability_region.ratios or 0 do
      if row.stated[k] > row.measured[k] * (1 + stability_region.precision) then
        list[#list + 1] = ("%s states h w = %s at xi = %g, and %s is measured"):format(row.plugin.name,
          figure(row.stated[k]), stability_region.ratios[k], figure(row.measured[k]))
      end
    end
  end
  return list
end

stability_region.columns = { "integrator", "damping_ratio", "measured", "stated", "theory", "reason" }

function stability_region.rows(all)
  local rows = {}
  for _, row in ipairs(all) do
    for k, ratio in ipairs(stability_region.ratios) do
      rows[#rows + 1] = { integrator = row.plugin.name, damping_ratio = ratio, reason = row.why,
        measured = row.measured and row.measured[k], stated = row.stated and row.stated[k],
        theory = row.theory and row.theory[k] }
    end
  end
  return rows
end

return stability_region
