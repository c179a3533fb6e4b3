-- hooke bench SCENE.lua [name=value ...]: what accuracy costs with every integrator, and which one to take.
-- See tools/common/bench: benchmark.lua (the phases), reference.lua, sensitivity.lua, refinement.lua, report.lua.
--
-- The error x of a run: at a frame, the root mean square over all particles of the distance to the reference; of these,
-- the root mean square over the frames after the start (m): error_x_rms of bench.csv, whose other columns are described
-- in report.lua. v: the same for velocities (m/s). energy: the unaccounted
-- change of energy over the largest kinetic energy. Of a measure: the root mean square over the frames. The cost is the
-- wall time of the time loop, without what other programs took of the processor: of repeats the shortest, as nothing but
-- such programs makes a run longer.
local argparse = require("argparse")
local benchmark = require("common.bench.benchmark")
local command_line = require("common.run.command_line")
local equal = require("common.bench.equal")
local files = require("common.run.file")
local process = require("process")
local progress = require("common.run.progress")
local journal = require("common.bench.journal")
local report = require("common.bench.report")

local positive = command_line.positive

local function parser()
  local p = argparse("hooke bench", "What accuracy costs in a scene, with every integrator that fits it.")
  p:argument("scene", "the scene's script")
  p:argument("params", "name=value: parameters of the scene"):args("*")
  p:option("--integrators", "only these: a,b,c; a name may have settings, xpbd:substeps=20")
  p:option("--vary", "name=a,b,c: each method with each of these values of a parameter of the scene; the reference has "
    .. "the scene's own")
  p:option("--target", "the error to compare costs at"):default("1e-3"):convert(positive("--target"))
  p:option("--finest", "the smallest error to go down to (a tenth of the target)"):convert(positive("--finest"))
  p:option("--metric", "x (m) or v (m/s): root mean square over the particles, then over the frames; energy; or a "
    .. "measure of the scene"):default("x")
  p:option("--until", "end of the runs, s (the scene's duration)"):target("until_"):convert(positive("--until"))
  p:option("--budget", "s for all of it, about"):default("120"):convert(positive("--budget"))
  p:option("--threads", "of each run"):default("1"):convert(command_line.whole("--threads"))
  p:option("--jobs", "processes at once for the reference (timed runs are alone)")
    :convert(command_line.whole("--jobs"))
  p:option("--out", "where the results go (out/bench/SCENE)")
  p:flag("--trust", "the scene may use plugins beside it")
  p:flag("--quiet", "no progress")
  return p
end

local function complain(format, ...)
  return command_line.complain("bench", format:format(...))
end

local function refuse_file(why)
  complain("%s", why)
  return 4
end

local function params_of(list)
  local params = {}
  for _, word in ipairs(list) do
    local name, value = word:match("^([%w_]+)=(.*)$")
    if not name then return nil, ("'%s' is not name=value"):format(word) end
    params[name] = value
  end
  return params
end

-- ---- printing ----

local function print_reference(b)
  local r = b.reference
  if b.exact then
    print(("reference     the scene's exact solution; beside it %s, %.1e m off it"):format(r.description, b.exact))
  else
    print(("reference     %s; they differ by %.1e%s"):format(r.description, r.size, b.goal.unit))
  end
  if b.doubted then
    print("warning: these two methods agree far better with one another than with the scene's exact solution: "
      .. "is it right?")
  end
  if not b.horizon then return end
  print(("horizon       %.4g s: over %.4g s the references end %.2g m apart, %s;\n              errors mean something "
    .. "up to the horizon, and are measured there"):format(b.horizon, b.cut_from.t, b.cut_from.size, b.cut_from.late
    and "and there was no time to refine them (a larger --budget may take them further)"
    or "however fine: the motion is not determined (chaos, or a force that is not smooth)"))
end

local function print_conditioning(b)
  local c = b.conditioning
  if not c then return print(("conditioning  not measured: %s"):format(b.conditioning_failed)) end
  local sizes = {}
  for _, s in ipairs(c.sizes) do
    sizes[#sizes + 1] = ("%.2g (at worst %.2g) for %.0e"):format(s.growth, s.worst, s.size)
  end
  print(("conditioning  random displacements of the start, relative to %.3g m, have grown at the end by %s (%d seeds)")
    :format(c.extent, table.concat(sizes, ", "), c.seeds))
  local small, large = c.sizes[1], c.sizes[#c.sizes]
  if small.growth > 3 * large.growth or large.growth > 3 * small.growth then
    print("              the growth depends on the size: the start balances on an edge, as cloth that will buckle")
  end
  print(("floor         rounding alone: %.1e%s in double precision, %.1e in single; errors below %.1e are not told")
    :format(c.floor, b.goal.unit, c.floor_single, b.goal.support))
  if b.goal.support > b.goal.target then
    print(("              this is above the target, %.1e: methods are compared down to it"):format(b.goal.target))
  end
end

-- Prints methods that are refused for the same reason in one line; the name of the plugin is removed from the reason to
-- compare them.
local function print_refused(b)
  local reasons, labels = {}, {}
  for _, method in ipairs(b.methods) do
    local why = method.refused and method.refused:gsub("%s+", " "):gsub("^" .. method.plugin .. ": ", "")
    if why and not labels[why] then
      reasons[#reasons + 1], labels[why] = why, {}
    end
    if why then table.insert(labels[why], method.label) end
  end
  if #reasons > 0 then print("\nthese do not fit the scene") end
  for _, why in ipairs(reasons) do print(("  %s: %s"):format(table.concat(labels[why], ", "), why)) end
end

local function print_warnings(b)
  for _, method in ipairs(b.methods) do
    if report.weak_order(method, method.observed) then
      print(("warning: %s does not show its order here: observed %.1f, declared %g"):format(method.label,
        method.observed, method.order))
    end
    local halved = report.halved(method, b.goal)
    if halved then
      print(("warning: %s halved its steps where Newton's iteration did not converge%s; a force with a "
        .. "wrong dF/dx does that, too: hooke check"):format(method.label, halved.longest
        and (" (not at dt %.3g s)"):format(halved.longest) or ""))
    end
  end
  for _, labels in ipairs(equal.methods(b.methods)) do
    print(("equal in effect: %s have the same errors, steps and evaluations, to the last bit"):format(table.concat(labels, " | ")))
  end
  for _, one in ipairs(equal.settings(b.methods)) do
    print(("equal in effect: %s took the same steps with %s"):format(one.label, table.concat(one.settings, " | ")))
  end
end

local function print_all(b)
  print_reference(b)
  print_conditioning(b)
  print_refused(b)
  report.table(b.ranking, b.goal, io.stdout)
  print_warnings(b)
  print("\n" .. (b.recommended and "take " or "") .. b.recommendation)
  print(("bench itself: %.2g s beside %.3g s of timed runs (%.1f %%); reference and conditioning: %.3g s"):format(
    b.own_s, b.timed, 100 * b.own_s / math.max(b.timed, 1e-9), b.reference_s))
end

-- ---- files ----

local function more_of(b, o)
  local c, r = b.conditioning, b.reference
  local chosen = b.recommended
  return {
    scene = b.explained.scene, params = o.params, metric = b.metric, target = o.target, finest = o.finest,
    until_s = b.limit, fps = b.fps, particles = b.explained.particles, horizon_s = b.horizon,
    error_definition = "RMS over the particles at each frame, then RMS (max: largest) over the frames after the start",
    reference = { methods = r.description, error = r.size, exact = b.exact ~= nil, exact_error = b.exact,
      supports_errors_above = b.goal.support },
    conditioning = c and { growth = c.growth, floor = c.floor, floor_single = c.floor_single, extent = c.extent,
      seeds = c.seeds, sizes = c.sizes },
    equal_in_effect = equal.methods(b.methods),
    recommendation = { text = b.recommendation, row = chosen and report.flat(chosen, b.goal) },
    overhead_s = b.own_s, timed_s = b.timed, threads = o.threads }
end

local function draw(b, out)
  local goal = b.goal
  local n = b.explained.particles
  goal.title = ("Speed against error: %s, %d particle%s, %.4g s"):format(b.explained.scene, n, n == 1 and "" or "s",
    b.limit)
  goal.axis = goal.metric == "energy" and "energy drift, relative" or goal.metric == "x"
    and "RMS error of the positions, m" or goal.metric == "v" and "RMS error of the velocities, m/s"
    or "error of " .. goal.metric
  return report.draw(b.methods, goal, b.recommended, out .. "/bench")
end

local function write_all(b, o, out)
  local fine, why = report.csv(b.methods, b.goal, out .. "/bench.csv")
  if fine then fine, why = report.json(b.methods, b.goal, more_of(b, o), out .. "/bench.json") end
  if not fine then return refuse_file(why) end
  fine, why = draw(b, out)
  print(("wrote %s/bench.csv, bench.json%s"):format(out, fine and ", bench.png, bench.svg" or ""))
  return fine and 0 or refuse_file(why)
end

-- ---- the whole command ----

local function fingerprint(o)
  local told = { metric = o.metric, target = o.target, finest = o.finest, until_ = o.until_, threads = o.threads,
    vary = o.vary }
  return journal.hash(journal.of_scene(o.scene, o.params) .. journal.canonical(told))
end

local function main()
  local o = command_line.parse("bench", parser())
  if not o then return 1 end
  local why
  o.params, why = params_of(o.params)
  if not o.params then return complain("%s", why) end
  o.finest = o.finest or o.target / 10
  local b
  b, why = benchmark.new(o)
  if not b then return complain("%s", why) end
  local name = o.scene:match("([^/]+)%.lua$") or o.scene
  local out = o.out or "out/bench/" .. name
  local made, refused = files.make_folder(out)
  if not made then return refuse_file(refused) end
  b.record, why = journal.open(out .. "/bench.state.jsonl", fingerprint(o))
  if not b.record then return refuse_file(why) end
  local bar, phase = progress.new { what = "bench " .. name, quiet = o.quiet }, nil
  if b.record.count > 0 then bar:say(("taking up %d runs of an interrupted bench"):format(b.record.count)) end
  b.each = function(case, result)
    bar:add { failed = result.failed ~= nil and result.fits ~= false, note = ("%s: %s"):format(phase, case.integrator),
      part = math.min((process.clock() - bar.begun) / o.budget, 0.99) } -- the bench ends after its budget at the latest
  end
  b.tick = function() bar:tick() end
  local fine
  fine, why = benchmark.measure(b, function(what) phase = what end)
  bar:finish()
  if not fine then return complain("%s", why) end
  print_all(b)
  local code = write_all(b, o, out)
  if b.record.failed then complain("an interrupted bench could not have been taken up: %s", b.record.failed) end
  if code == 0 then b.record:remove() end
  return code
end

return main()
