-- Stability on the linear oscillator x'' = -g x' - w^2 x: the measured stability of a method's steps, compared with the
-- growth that its plugin states and with theory.
--
-- Growth is measured on runs of hooke itself (region_scene.lua: hundreds of oscillators in one). A step is a linear
-- map, so positions and velocities obey a linear recurrence s(k+p) = sum c_j s(k+j), whose characteristic roots are
-- those of the step, p = 2 for a one-step method and more with a history (Prony 1795). The smallest p whose
-- least-squares residual is at rounding level is taken, and its largest root is the growth. Components too small to
-- affect the residual have decayed, so they are not the largest.
--
-- The largest stable step is the first h w at which a motion grows by more than 1e-10 per step (apart from rounding):
-- it is searched in steps of 4 % and then refined. The search begins at h max(w, g) = 0.05, where methods that are
-- stable nowhere grow by h^4 w^4/8 = 8e-7; a limit below that counts as none.
local amplification = require("amplification")
local json = require("cjson").new()
local plot = require("common.run.plot")
local process = require("process")
local case_process = require("common.run.case_process")

json.encode_invalid_numbers(true)
json.decode_invalid_numbers(true)

local stability_region = {}

stability_region.ratios = { 0, 0.01, 0.1, 0.5, 1, 2, 10 } -- damping over critical damping, xi = g/(2 w)

local steps, startup, most_order = 26, 8, 7
-- The residual of the right recurrence is 1e-15 to 1e-10, depending on the method's algebraic tolerance; a longer one
-- is taken where it fits a hundred times better. A motion that decays below 1e-5 of its size at the start soon reaches
-- rounding level, where any recurrence fits: the growth is then taken from the decay itself.
local rounding, residual_limit, better, decay_limit = 1e-13, 1e-8, 0.01, 1e-5

-- ---- growth of a sequence ----

local function size_of(sequences, first, last)
  local size = 0
  for _, s in ipairs(sequences) do
    for k = first, last do
      if s[k] ~= s[k] then return math.huge end
      size = math.max(size, math.abs(s[k]))
    end
  end
  return size
end

-- Rows s(k) .. s(k+p-1) | s(k+p) of all sequences, each scaled to 1, without those at rounding level.
local function equations(sequences, p)
  local rows = {}
  for k = startup, #sequences[1] - p do
    local common = size_of(sequences, k, k + p)
    for _, s in ipairs(sequences) do
      local row, size = {}, size_of({ s }, k, k + p)
      for j = 0, p do row[j + 1] = s[k + j] / size end
      if size > decay_limit * common then rows[#rows + 1] = row end
    end
  end
  return rows
end

-- Least squares by Householder reflections: the coefficients, and the RMS residual.
local function least_squares(rows, p)
  local m = #rows
  for j = 1, p do
    local norm, dot = 0, {}
    for i = j, m do norm = norm + rows[i][j] ^ 2 end
    norm = math.sqrt(norm)
    if norm < 1e-14 then return nil end
    if rows[j][j] > 0 then norm = -norm end
    local head = rows[j][j] - norm
    for c = j + 1, p + 1 do
      local sum = head * rows[j][c]
      for i = j + 1, m do sum = sum + rows[i][j] * rows[i][c] end
      dot[c] = sum / (norm * head)
    end
    for c = j + 1, p + 1 do
      rows[j][c] = rows[j][c] + dot[c] * head
      for i = j + 1, m do rows[i][c] = rows[i][c] + dot[c] * rows[i][j] end
    end
    rows[j][j] = norm
  end
  local c, rest = {}, 0
  for j = p, 1, -1 do
    local sum = rows[j][p + 1]
    for l = j + 1, p do sum = sum - rows[j][l] * c[l] end
    c[j] = sum / rows[j][j]
  end
  for i = p + 1, m do rest = rest + rows[i][p + 1] ^ 2 end
  return c, math.sqrt(rest / math.max(1, m - p))
end

-- |M^N|^(1/N), N = 2^45: the largest root of u^p = sum c_j u^(j-1), through the companion matrix.
local function largest_root(c, p)
  local M, logarithm, weight = {}, 0, 1
  for i = 1, p do
    M[i] = {}
    for j = 1, p do M[i][j] = i == p and c[j] or j == i + 1 and 1 or 0 end
  end
  for _ = 1, 45 do
    local size, square = 0, {}
    for i = 1, p do for j = 1, p do size = math.max(size, math.abs(M[i][j])) end end
    if size == 0 then return 0 end
    logarithm = logarithm + weight * math.log(size)
    weight = weight / 2
    for i = 1, p do
      square[i] = {}
      for j = 1, p do
        local sum = 0
        for l = 1, p do sum = sum + M[i][l] * M[l][j] / size / size end
        square[i][j] = sum
      end
    end
    M = square
  end
  return math.exp(logarithm)
end

-- The last step before the motion decays below `decay_limit` times its largest size.
local function last_before_decay(sequences)
  local most = 0
  for k = 1, #sequences[1] do
    local size = size_of(sequences, k, k)
    most = math.max(most, size)
    if size <= decay_limit * most then return k - 1 end
  end
  return #sequences[1]
end

-- The growth factor of a step; nil: no recurrence fits, since the method's steps are not linear.
function stability_region.growth_of(sequences)
  local count = #sequences[1]
  if size_of(sequences, 1, count) == math.huge then return math.huge end
  local last = last_before_decay(sequences)
  if last < 3 then return 0 end
  if last < count then return (size_of(sequences, last, last) / size_of(sequences, 1, 1)) ^ (1 / (last - 1)) end
  local best, least = nil, residual_limit / better
  for p = 1, most_order do
    local c, residual = least_squares(equations(sequences, p), p)
    if c and residual <= better * least then best, least = largest_root(c, p), residual end
    if least <= rounding then break end
  end
  return best
end

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
    growth[k] = stability_region.growth_of(sequences) or false
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

-- ---- theory ----

-- |R(z)| of a Runge-Kutta method at the two roots z of z^2 + hg z + hw^2 = 0, R(z) = sum c_k z^k.
local function polynomial(c)
  local function size(re, im)
    local a, b = 0, 0
    for k = #c, 1, -1 do a, b = a * re - b * im + c[k], a * im + b * re end
    return math.sqrt(a * a + b * b)
  end
  return function(hw, hg)
    local d = hg * hg / 4 - hw * hw
    if d < 0 then return size(-hg / 2, math.sqrt(-d)) end
    local fast = -hg / 2 - math.sqrt(d)
    return math.max(size(fast, 0), fast < 0 and size(hw * hw / fast, 0) or 0)
  end
end

local function runge_kutta(c)
  return function() return stability_region.limits_of(polynomial(c)) end
end

local function at_ratios(f)
  return function()
    local list = {}
    for k, ratio in ipairs(stability_region.ratios) do list[k] = f(ratio) end
    return list
  end
end

-- s (h w)^2 + d h g = 4
local function recurrence(s, d)
  return at_ratios(function(x) return (math.sqrt(d * d * x * x + 4 * s) - d * x) / s end)
end

local any = at_ratios(function() return math.huge end)
local root = math.sqrt
local dormand_prince = runge_kutta { 1, 1, 1 / 2, 1 / 6, 1 / 24, 1 / 120, 1 / 600 }

-- Closed forms: Hairer and Wanner, Solving ODEs II, IV.2 and IV.3 (one-step methods, by their stability functions),
-- V.1 (BDF); the recurrences of leapfrog (with the velocity predicted, v + h a) and symplectic Euler at the root -1;
-- Hairer, Norsett and Wanner, Solving ODEs I, III.10 (Stoermer), at -1: 4 = (h w)^2 sum sigma_j 2^j + 2 h g sum gamma_j 2^j.
local theory = {
  euler = at_ratios(function(x) return x < 1 and 2 * x or 2 / (x + root(x * x - 1)) end),
  symplectic_euler = at_ratios(function(x) return 2 * (root(1 + x * x) - x) end),
  leapfrog = at_ratios(function(x) return 2 * (root(1 + 4 * x * x) - 2 * x) end),
  midpoint = runge_kutta { 1, 1, 1 / 2 },
  trapezoid = runge_kutta { 1, 1, 1 / 2 },
  rk4 = runge_kutta { 1, 1, 1 / 2, 1 / 6, 1 / 24 },
  dopri5 = dormand_prince,
  arkode = dormand_prince,
  stoermer = function() return { root(2) } end,
  stoermer_wide2 = recurrence(1, 1.376),
  stoermer_wide3 = recurrence(1 + 1 / 3 - 0.16, 2 * (2 + 5 / 3 - 8 * 0.66 + 16 * 0.17)),
  stoermer_wide4 = recurrence(2 - 16 * 0.004 - 32 * 0.015, 2 * (5 + 5 / 3 - 16 * 0.67 + 32 * 0.18)),
  backward_euler = any,
  implicit_midpoint = any,
  implicit_trapezoid = any,
  bdf2 = any,
  tr_bdf2 = any,
  esdirk4 = any,
  imex = any,
  baraff_witkin = any,
  local_global = any,
  xpbd = any,
}

-- Limits of h w known in closed form, in the order of the ratios (perhaps of the first only); nil where there is none.
function stability_region.theory(name) return theory[name] and theory[name]() end

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
  return { plugin = plugin, measured = answer.limits, why = answer.why, theory = stability_region.theory(plugin.name),
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

-- ---- pictures ----

-- Of z = h lambda in the complex plane; the lower half mirrors the upper one. On both half-axes the root and its double
-- are taken: a method with one evaluation of the damping may have a smaller limit when the two roots differ (see the
-- table).
local grid = { low = -6, high = 2, top = 6, count = 160 }

local function panel(stated)
  local rows = {}
  for i = 0, grid.count do
    for j = 0, grid.count do
      local re, im = grid.low + (grid.high - grid.low) * i / grid.count, grid.top * j / grid.count
      rows[#rows + 1] = { re, im, stated(math.sqrt(re * re + im * im), -2 * re) <= 1 + 1e-7 and 1 or 0 }
    end
  end
  return rows
end

local function title_of(plugin)
  return ("%s, order %d"):format(plugin.name, plugin.order)
end

-- Draws the regions of all plugins that state their growth as NAME.png and NAME.svg; returns true, or nil and the
-- reason.
function stability_region.draw(path, plugins)
  local data, panels = {}, {}
  for _, plugin in ipairs(plugins) do
    local stated = stability_region.stated(plugin)
    if stated then
      local name = "P" .. #panels + 1
      data[#data + 1] = { name = name, rows = panel(stated) }
      panels[#panels + 1] = ("set title %s noenhanced offset 0,-0.7\n"):format(plot.quote(title_of(plugin)))
        .. ("plot $%s using 1:2:3 with image notitle"):format(name)
    end
  end
  if #panels == 0 then return nil, "no method states its growth" end
  local columns = math.min(6, #panels)
  local last = table.remove(panels)
  local head, item = last:match("^(.-)\nplot (.*)$")
  return plot.draw(path, { width = 260 * columns, height = 240 * math.ceil((#panels + 1) / columns) + 60,
    data = data, more = { item .. "\nunset multiplot" }, commands = { "unset key", "unset colorbox", "unset grid",
      "set palette defined (0 '#FFFFFF', 1 '#8FB3D9')", "set cbrange [0:1]",
      ("set xrange [%g:%g]"):format(grid.low, grid.high), ("set yrange [0:%g]"):format(grid.top), "set size ratio -1",
      "set xtics 2", "set ytics 2", "set arrow from 0,0 to 0,6 nohead front lc rgb '#000000' lw 0.6 dt 3",
      "set xlabel 'Re h {/Symbol l}' offset 0,0.6", "set ylabel 'Im h {/Symbol l}' offset 1.2,0",
      ("set multiplot layout %d,%d title 'Stable (filled): growth of a step at most 1'"):format(
        math.ceil((#panels + 1) / columns), columns), table.concat(panels, "\n"), head } })
end

return stability_region
