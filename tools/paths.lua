-- hooke paths SCENE.lua [name=value ...]: the paths of particles by several methods, over each other.
-- Euler's spiral beside the circle, or a wave that a method damps: each method runs the scene in a process of its own, and
-- one diagram shows where the particles went, with a mark at each start. A method with a step of its own (euler@0.05, or --dt
-- for all) has a corner at each step.
local argparse = require("argparse")
local case_process = require("common.run.case_process")
local command_line = require("common.run.command_line")
local csv = require("common.run.csv")
local files = require("common.run.file")
local methods = require("common.bench.methods")
local plot = require("common.run.plot")

local names = "txyz" -- of the columns of a row
local most_curves = 24
local usual = "euler,midpoint,leapfrog,rk4"

local function complain(format, ...) return command_line.complain("paths", format:format(...)) end

local function parser()
  local p = argparse("hooke paths", "The paths of particles by several methods, over each other.")
  p:argument("scene", "the scene's script, and its parameters as name=value"):args("+")
  p:option("--integrators", "methods, a,b,c; a name may have settings, and @DT its step in s: euler@0.05"):default(usual)
  p:option("--dt", "step of those without one, s"):convert(command_line.positive("--dt"))
  p:option("--of", "particles, by their ids, 1,5,9"):default("1")
  p:option("--axes", "across and up, two of t, x, y, z (the two directions in which the motion is widest)")
  p:option("--until", "end of the runs, s (the scene's)"):convert(command_line.positive("--until"))
  p:option("--out", "where the results go (out/paths/SCENE)")
  p:flag("--trust", "the scene may use plugins beside it")
  return p
end

-- ---- the command line ----

local function ids_of(text)
  local list = {}
  for word in (text .. ","):gmatch("([^,]*),") do
    local id = math.tointeger(tonumber(word))
    if not id or id < 1 then return nil, ("--of: '%s' is not the id of a particle"):format(word) end
    list[#list + 1] = id
  end
  return list
end

local function axes_of(text)
  local across, up = text:match("^([txyz])([xyz])$")
  if not across or across == up then return nil, ("--axes: '%s' are not two of t, x, y and z, such as xz or tx"):format(text) end
  return { names:find(across), names:find(up) }
end

local function options()
  local o = command_line.parse("paths", parser())
  if not o then return nil end
  local fine, why = command_line.take_scene("paths", o)
  if not fine then return nil, why end
  o.methods, why = methods.with_steps(o.integrators)
  if not o.methods then return nil, why end
  o.ids, why = ids_of(o.of)
  if not o.ids then return nil, why end
  if o.axes then
    o.axes, why = axes_of(o.axes)
    if not o.axes then return nil, why end
  end
  local curves = #o.ids * #o.methods
  if curves > most_curves then
    return nil, ("%d curves (particles times methods) cannot be told apart: at most %d"):format(curves, most_curves)
  end
  return o
end

-- ---- the runs ----

-- Rows { t, x, y, z } of each particle; a particle that is not there (not yet born, drained) leaves a gap.
local function note(rows, run, ids)
  local state, there = run:state(), {}
  for _, id in ipairs(state:ids()) do there[id] = true end
  for k, id in ipairs(ids) do
    local x = there[id] and state:position(id) or { 0 / 0, 0 / 0, 0 / 0 }
    table.insert(rows[k], { state.t, x[1], x[2], x[3] })
  end
end

-- In a process of its own: the frames, which with a step of its own are its steps.
local function follow(case)
  local fps = case.dt and 1 / case.dt or nil
  local scene, refused = hooke.load(case.scene, case.params,
    { integrator = case.integrator, dt = case.dt, fps = fps, ["until"] = case["until"], trust = case.trust })
  if not scene then return { failed = refused } end
  local rows = {}
  for k = 1, #case.ids do rows[k] = {} end
  local fine, run = pcall(scene.run, scene, { to = 0 })
  local first = fine and run:summary()
  local k = 0
  while fine do
    note(rows, run, case.ids)
    k = k + 1
    local t = math.min(k / first.fps, first["end"])
    if (k - 1) / first.fps >= first["end"] * (1 - 1e-12) then break end
    fine, run = pcall(scene.run, scene, { to = t })
  end
  local failed = not fine and tostring(run):gsub("^%S*tools/paths%.lua:%d+: ", "") or nil -- not the place in this tool
  return { rows = rows, failed = failed, dt = fine and run:summary().dt_max or nil }
end

local function run_all(o)
  local results = {}
  for k, method in ipairs(o.methods) do
    results[k] = case_process.run { scene = o.scene, params = o.params, integrator = method.integrator, dt = method.dt or o.dt,
      ["until"] = o["until"], ids = o.ids, trust = o.trust, execute = follow }
  end
  return results
end

-- ---- what is drawn ----

local function each_row(results, visit)
  for _, r in ipairs(results) do
    for _, rows in ipairs(r.rows or {}) do
      for _, row in ipairs(rows) do visit(row) end
    end
  end
end

-- The two directions in which the motion is widest, in the order of the alphabet.
local function widest(results)
  local low, high = {}, {}
  each_row(results, function(row)
    for k = 2, 4 do
      if row[k] == row[k] then low[k], high[k] = math.min(low[k] or row[k], row[k]), math.max(high[k] or row[k], row[k]) end
    end
  end)
  local order = { 2, 3, 4 }
  local function width(k) return (high[k] or 0) - (low[k] or 0) end
  table.sort(order, function(a, b) return width(a) > width(b) or (width(a) == width(b) and a < b) end)
  return { math.min(order[1], order[2]), math.max(order[1], order[2]) }
end

local function title_of(o, method, k)
  return #o.ids == 1 and method.label or ("%s, particle %d"):format(method.label, o.ids[k])
end

local function curves_of(o, results, axes)
  local curves, starts = {}, {}
  for m, method in ipairs(o.methods) do
    for k, rows in ipairs(results[m].rows or {}) do
      local points = {}
      for i, row in ipairs(rows) do points[i] = { row[axes[1]], row[axes[2]] } end
      curves[#curves + 1] = { title = title_of(o, method, k), points = points, marks = false }
      starts[k] = starts[k] or points[1]
    end
  end
  return curves, starts
end

local function draw(o, results)
  local axes = o.axes or widest(results)
  local curves, starts = curves_of(o, results, axes)
  local function axis(k)
    local name = names:sub(axes[k], axes[k])
    return { label = name .. (name == "t" and ", s" or ", m") }
  end
  return plot.draw(o.out .. "/paths", { title = ("Paths: %s"):format(o.scene:match("[^/]+$")), x = axis(1), y = axis(2),
    curves = curves, height = axes[1] > 1 and 900 or nil, commands = { axes[1] > 1 and "set size ratio -1" or "set size noratio" },
    data = { { name = "STARTS", rows = starts } },
    more = { "$STARTS using 1:2 with points pt 7 ps 1.4 lc rgb '#000000' title 'start'" } })
end

local function cell(x) return x == x and ("%.17g"):format(x) or "" end

local function table_of(o, results)
  local lines = { "method,particle,t,x,y,z" }
  for m, method in ipairs(o.methods) do
    for k, rows in ipairs(results[m].rows or {}) do
      for _, row in ipairs(rows) do
        lines[#lines + 1] = ("%s,%d,%.17g,%s,%s,%s"):format(csv.text(method.label, true), o.ids[k], row[1], cell(row[2]),
          cell(row[3]), cell(row[4]))
      end
    end
  end
  return table.concat(lines, "\n") .. "\n"
end

-- Says what failed, and where the others ended; gives how many have a path.
local function say(o, results)
  local drawn = 0
  for m, method in ipairs(o.methods) do
    local r = results[m]
    if r.rows and #r.rows[1] > 0 then drawn = drawn + 1 end
    print(("%-28s %s"):format(method.label, r.failed or ("longest step %.3g s"):format(r.dt)))
  end
  return drawn
end

-- The reason why no method gave a path, where all have the same.
local function common_reason(results)
  local why = results[1].failed
  for _, r in ipairs(results) do
    if r.failed ~= why then return nil end
  end
  return why
end

-- The first particle that is at no time in any run.
local function never_there(o, results)
  local seen = {}
  for _, r in ipairs(results) do
    for k, rows in ipairs(r.rows or {}) do
      for _, row in ipairs(rows) do seen[k] = seen[k] or row[2] == row[2] end
    end
  end
  for k, id in ipairs(o.ids) do
    if not seen[k] then return id end
  end
end

local function main()
  local o, why = options()
  if not o then return why and complain("%s", why) or 1 end
  local made, refused = files.make_folder(o.out)
  if not made then return complain("%s", refused) and 4 end
  local results = run_all(o)
  local reason = common_reason(results)
  if reason then return complain("%s", reason) end
  if say(o, results) == 0 then return complain("no method gave a path: the lines above say why") end
  local missing = never_there(o, results)
  if missing then return complain("--of: there is no particle with the id %d at any frame", missing) end
  local fine
  fine, why = files.write(o.out .. "/paths.csv", table_of(o, results))
  if fine then fine, why = draw(o, results) end
  if not fine then return complain("%s", why) and 4 end
  print(("wrote %s/paths.csv, paths.png, paths.svg"):format(o.out))
  return 0
end

return main()
