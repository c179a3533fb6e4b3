-- hooke scaling SCENE.lua NAME=A,B,C [name=value ...]: what a particle costs, against how many there are.
-- The first parameter with several values sets the size of the scene; every method runs each size for a few seconds. The
-- cost of a particle is the time of the time loop, over the particles and the simulated time, without the first piece,
-- which warms the machine up, where there are more. Pieces are frames, or where these have thousands of steps of an
-- explicit method parts of them with some hundred. A method's step is the one that `hooke run` takes, or that of its
-- settings (--dt; `name:parameter=value`): sizes are compared, not accuracies, for which there is `hooke bench`.
local argparse = require("argparse")
local case_process = require("common.run.case_process")
local command_line = require("common.run.command_line")
local csv = require("common.run.csv")
local files = require("common.run.file")
local methods = require("common.bench.methods")
local plot = require("common.run.plot")
local progress = require("common.run.progress")

local patience = 20 -- what takes so many budgets is given up, and with it the method's larger sizes
local piece = 100   -- steps

local function complain(format, ...) return command_line.complain("scaling", format:format(...)) end

local function refuse_file(why)
  complain("%s", why)
  return 4
end

local function parser()
  local p = argparse("hooke scaling", "What a particle costs against how many there are.")
  p:argument("scene", "the scene's script, and its parameters; one has several values, N=10,32,100"):args("+")
  p:option("--integrators", "methods, a,b,c; a name may have settings, and @DT its step in s: bdf2:tolerance=1e-3@0.01 "
    .. "(the scene's own)")
  p:option("--beside", "a table to draw as well, of lines LABEL,PARTICLES,COST: what another program takes"):count("*")
  p:option("--threads", "of each run"):default("1"):convert(command_line.whole("--threads"))
  p:option("--budget", "s for each size and method, about"):default("3"):convert(command_line.positive("--budget"))
  p:option("--out", "where the results go (out/scaling/SCENE)")
  p:flag("--trust", "the scene may use plugins beside it")
  p:flag("--quiet", "no progress")
  return p
end

-- ---- the command line ----

-- The name of the parameter with several values, which leaves `given`, and the values; or nil and why there is none.
local function take_sizes(given)
  local found
  for name, value in pairs(given) do
    if value:find(",", 1, true) then
      if found then return nil, ("%s and %s both have several values: one sets the size"):format(found, name) end
      found = name
    end
  end
  if not found then return nil, "no parameter has several values: name the one that sets the size, N=10,32,100" end
  local values = methods.split(given[found])
  given[found] = nil
  return found, values
end

local function lines_of(path)
  local file, why = io.open(path)
  if not file then return nil, ("cannot read %s"):format(why) end
  local curves, by_label, row = {}, {}, 0
  for line in file:lines() do
    row = row + 1
    local label, n, cost = line:match("^([^,]+),([^,]+),([^,]+)$")
    n, cost = tonumber(n), tonumber(cost)
    if not (n and cost and n > 0 and cost > 0) then
      return nil, ("%s:%d: not LABEL,PARTICLES,COST with numbers above 0"):format(path, row)
    end
    if not by_label[label] then
      by_label[label] = { label = label, points = {} }
      curves[#curves + 1] = by_label[label]
    end
    table.insert(by_label[label].points, { n, cost })
  end
  file:close()
  return curves
end

-- ---- measuring ----

-- The parts of a frame to measure by.
local function parts_of(start)
  local limit = tonumber(start.dt_limit)
  return limit and limit > 0 and limit < math.huge and math.max(1, math.floor(1 / (start.fps * piece * limit))) or 1
end

-- In a process of its own: pieces, until they have taken the budget.
local function measure(case)
  local scene, refused = hooke.load(case.scene, case.params, { integrator = case.integrator, dt = case.dt,
    threads = case.threads, trust = case.trust })
  if not scene then return { failed = refused } end
  local fine, run = pcall(scene.run, scene, { to = 0 })
  if not fine then return { failed = run } end
  local before = run:summary()
  local warm, k, rate, s = nil, 0, before.fps * parts_of(before)
  repeat
    k = k + 1
    fine, run = pcall(scene.run, scene, { to = math.min(k / rate, before["end"]) })
    if not fine then return { failed = run } end
    s = run:summary()
    if k == 1 and s.step_wall_s < case.budget and s.t < before["end"] then warm = s end
  until s.step_wall_s >= case.budget or s.t >= before["end"]
  local from = warm or before
  return { particles = s.particles, steps = s.steps - from.steps, simulated = s.t - from.t, dt = s.dt_max,
    integrator = s.integrator, seconds = s.step_wall_s - from.step_wall_s }
end

local function cases_of(o)
  local list = {}
  for _, method in ipairs(o.methods) do
    for _, value in ipairs(o.values) do
      local params = {}
      for name, given in pairs(o.params) do params[name] = given end
      params[o.name] = value
      list[#list + 1] = { scene = o.scene, params = params, value = value, method = method, integrator = method.integrator,
        dt = method.dt, threads = o.threads, budget = o.budget, trust = o.trust, execute = measure,
        timeout = patience * o.budget }
    end
  end
  return list
end

-- One after another: their times are what is wanted. A method that was too slow for one size is not tried at the next.
local function measure_all(o)
  local rows, given_up, cases = {}, {}, cases_of(o)
  local bar = progress.new { what = "scaling", total = #cases, quiet = o.quiet }
  for _, case in ipairs(cases) do
    local r = not given_up[case.method] and case_process.run(case) or { failed = "a smaller one was too slow" }
    if r.verdict == "timeout" then given_up[case.method] = true end
    if r.particles and r.seconds > 0 then r.cost = r.seconds / r.simulated / r.particles end
    rows[#rows + 1] = { case = case, result = r }
    bar:add { failed = not r.cost, note = ("%s, %s=%s"):format(case.method.label, o.name, case.value) }
  end
  bar:finish()
  return rows
end

-- ---- results ----

local function print_rows(o, rows)
  print(("%-28s %10s %10s %9s %12s %12s"):format("method", o.name, "particles", "step, s", "ns a step", "us a second"))
  for _, row in ipairs(rows) do
    local r, case = row.result, row.case
    if r.cost then
      print(("%-28s %10s %10d %9.2e %12.3g %12.4g"):format(case.method.label, case.value, r.particles, r.dt,
        1e9 * r.seconds / r.steps / r.particles, 1e6 * r.cost))
    else
      print(("%-28s %10s %s"):format(case.method.label, case.value, r.failed or "no step was taken"))
    end
  end
end

local function table_of(rows)
  local lines = { "method,value,particles,threads,steps,dt_s,simulated_s,wall_s,cost_s" }
  for _, row in ipairs(rows) do
    local r, case = row.result, row.case
    if r.cost then
      lines[#lines + 1] = ('%s,%s,%d,%d,%d,%.9g,%.9g,%.9g,%.9g'):format(csv.text(case.method.label, true), csv.cell(case.value),
        r.particles, case.threads, r.steps, r.dt, r.simulated, r.seconds, r.cost)
    end
  end
  return table.concat(lines, "\n") .. "\n"
end

local function curves_of(o, rows)
  local curves, by_method = {}, {}
  for _, method in ipairs(o.methods) do
    by_method[method] = { title = method.label, points = {} }
    curves[#curves + 1] = by_method[method]
  end
  for _, row in ipairs(rows) do
    if row.result.cost then table.insert(by_method[row.case.method].points, { row.result.particles, 1e6 * row.result.cost }) end
  end
  for _, other in ipairs(o.others) do
    local curve = { title = other.label, points = {} }
    for _, p in ipairs(other.points) do curve.points[#curve.points + 1] = { p[1], 1e6 * p[2] } end
    curves[#curves + 1] = curve
  end
  return curves
end

local function write_all(o, rows)
  local fine, why = files.write(o.out .. "/scaling.csv", table_of(rows))
  if not fine then return refuse_file(why) end
  fine, why = plot.draw(o.out .. "/scaling", { title = ("Cost against size: %s"):format(o.scene:match("[^/]+$")),
    x = { label = "particles", log = true }, y = { label = "time per particle and simulated second, µs", log = true },
    curves = curves_of(o, rows) })
  print(("wrote %s/scaling.csv%s"):format(o.out, fine and ", scaling.png, scaling.svg" or ""))
  return fine and 0 or refuse_file(why)
end

local function read_others(o)
  o.others = {}
  for _, path in ipairs(o.beside) do
    local curves, why = lines_of(path)
    if not curves then return nil, why end
    table.move(curves, 1, #curves, #o.others + 1, o.others)
  end
  return true
end

local function options()
  local o = command_line.parse("scaling", parser())
  if not o then return nil end
  local fine, why = command_line.take_scene("scaling", o)
  if not fine then return nil, why end
  o.name, o.values = take_sizes(o.params)
  if not o.name then return nil, o.values end
  o.methods, why = methods.with_steps(o.integrators)
  if not o.methods then return nil, why end
  if #o.methods == 0 then o.methods = { { label = "the scene's method" } } end
  return o
end

local function main()
  local o, why = options()
  if not o then return why and complain("%s", why) or 1 end
  local fine
  fine, why = read_others(o)
  if not fine then return refuse_file(why) end
  fine, why = files.make_folder(o.out)
  if not fine then return refuse_file(why) end
  local rows = measure_all(o)
  for _, row in ipairs(rows) do
    if row.result.cost then
      print_rows(o, rows)
      return write_all(o, rows)
    end
  end
  local first = rows[1]
  return complain("no run gave a cost; the first, of %s=%s: %s", o.name, first.case.value, first.result.failed or "no step was taken")
end

return main()
