-- hooke explain SCENE.lua [name=value ...]: plugins, sizes, frequencies, stable steps; --cost: what each part costs.
-- With --cost: the cost and the effect of each force, constraint, corrector and source (common/cost/cost.lua).
local argparse = require("argparse")
local command_line = require("common.run.command_line")
local files = require("common.run.file")
local journal = require("common.bench.journal")
local json = require("cjson").new()
json.encode_invalid_numbers("null")

local function fail(message) return command_line.complain("explain", message) end

-- ---- the command line ----

local function parser_of()
  local p = argparse("hooke explain", "What a scene will load, its sizes, its frequencies, and the largest stable steps.")
  p:argument("scene", "the scene's script, then name=value: parameters of the scene"):args("*")
  p:flag("--cost", "what each force, constraint, corrector and source costs, and what the run is without it")
  p:option("--integrator", "with --cost: in place of the scene's")
  p:option("--until", "with --cost: end of the runs, s"):target("until_"):convert(command_line.positive("--until"))
  p:option("--repeats", "with --cost: runs of each, of which the median counts"):convert(command_line.whole("--repeats"))
  p:option("--out", "with --cost: the folder of the diagram (out/cost/SCENE)")
  p:flag("--json", "as one JSON object")
  p:flag("--trust", "the scene is trusted")
  return p
end

local needs_cost = { integrator = "--integrator", until_ = "--until", repeats = "--repeats", out = "--out" }

-- nil: what is wrong has been said.
local function parse()
  local o = command_line.parse("explain", parser_of())
  if not o then return nil end
  local why
  o.path, o.given, why = command_line.scene(o.scene)
  for name, option in pairs(needs_cost) do
    if o[name] and not o.cost then why = option .. " goes with --cost" end
  end
  if not o.path and not why then why = "no scene given: hooke explain SCENE.lua [name=value ...] [--cost]" end
  if why then return fail(why) and nil end
  return o
end

-- ---- the scene ----

local function seconds(x)
  return x ~= x and "not known" or x == math.huge and "any" or x == 0 and "none" or ("%.4g s"):format(x)
end

local by_host = { blocks = "from the blocks of its Jacobian; by its parameters from differences", differences = "from differences" }

local function print_loaded(e)
  print(("%s: %d particles (%d pinned), %d triangles, %.4g kg; state %.3g MB"):format(e.scene, e.particles, e.pinned,
    e.triangles, e.mass, e.state_bytes / 1e6))
  print(("%g s at %g frames a second with %s"):format(e.duration, e.fps, e.integrator))
  print("\nloaded")
  for _, p in ipairs(e.plugins) do
    print(("  %-11s %-14s %-16s %s"):format(p.kind, p.name, hooke.plain(p.label, true), p.edges and ("%d edges"):format(p.edges) or ""))
    if p.apart then
      print("                 without parts (add_part): every evaluation goes through all particles once more for it")
    end
    local from = by_host[p.differentiated_by]
    if from then print("                 derivatives (gradient, optimise): by the host, " .. from) end
  end
end

local function print_solver(e)
  if e.solver_libraries then print(("\nlinear systems\n  %s"):format(e.solver_libraries)) end
end

local function print_warnings(e)
  for k, warning in ipairs(e.warnings) do print((k == 1 and "\n" or "") .. "warning: " .. hooke.plain(warning, true)) end
end

local function print_steps(e)
  local s = e.spectrum
  print("\nlinearised at the start")
  print(("  frequencies up to   %.4g 1/s (a period of %.4g s)"):format(s.w_max,
    s.w_max > 0 and 2 * math.pi / s.w_max or math.huge))
  print(("  damping rates up to %.4g 1/s; of every mode at least %.3g + %.3g w^2"):format(s.g_max, s.alpha, s.beta))
  if s.b_max > 0 then print(("  velocities turn at up to %.4g 1/s"):format(s.b_max)) end
  if e.longest_step < math.huge then
    print(("  steps are divided into ones of at most %.4g s at the start, as forces or correctors demand"):format(e.longest_step))
  end
  if s.channel_rate > 0 then print(("  channels decay at   %.4g 1/s"):format(s.channel_rate)) end
  print("\nlargest stable step")
  local function rank(step) return step.limit == step.limit and step.limit or -1 end -- not known (NaN): last
  table.sort(e.steps, function(a, b) return rank(a) > rank(b) or (rank(a) == rank(b) and a.name < b.name) end)
  for _, step in ipairs(e.steps) do
    local note = step.growth_rate > 0
      and (" (chosen for accuracy: %.3g s; motion grows at %.3g 1/s)"):format(step.suggestion, step.growth_rate) or ""
    print(("  %-18s %-12s%s%s"):format(step.name, seconds(step.limit), note, step.name == e.integrator
      and ("  <- this scene; dt = %.4g s%s"):format(e.dt, e.dt_chosen and ", chosen" or ", given") or ""))
  end
end

-- Contact by a barrier needs implicit steps, each with some ten solutions of linear systems; contact by impulses needs
-- the steps that leapfrog takes without the barrier, and keeps surfaces apart as surely, with a smaller error. Measured:
-- 31 x 31 particles on a ball, 0.4 s: 49 steps of bdf2 6.2 s, 460 of leapfrog 1.3 s; a sheet that is wound up
-- (plugins/correctors/contact.c): 75 steps 6.1 s, 1,379 steps 2.1 s.
local STEPS_FOR_ONE = 45

-- For a scene with a barrier: which way of contact is cheaper, and how that was found; nil: not known, or no barrier.
local function contact_advice(e, o)
  local without
  for _, p in ipairs(e.plugins) do
    if p.kind == "force" and p.name == "barrier" then without = p.label end
  end
  local rest = without and hooke.explain(o.path, o.given, { trust = o.trust, without = { without } })
  for _, step in ipairs(rest and rest.steps or {}) do
    if step.name == "leapfrog" and step.limit > 0 and step.limit < math.huge and e.dt > 0 then
      local steps = math.max(1, e.dt / step.limit)
      return { steps = steps, limit = step.limit, cost = STEPS_FOR_ONE, take = steps > STEPS_FOR_ONE and "barrier" or "contact" }
    end
  end
end

local function print_contact(e)
  local c = e.contact
  if not c then return end
  print(("\ncontact\n  a step with the barrier costs as much as some %d of leapfrog with the corrector 'contact', whose stable"
    .. " step\n  here, %.3g s, is %.3g to one of this scene: %s"):format(c.cost, c.limit, c.steps, c.take == "contact"
    and "the corrector with leapfrog is cheaper, and damps less"
    or "the barrier with an implicit method is cheaper, though it damps more"))
end

-- Lists are lists where they are empty, and what there is none of is null.
local function print_json(e)
  for _, key in ipairs { "warnings", "steps", "measures", "plugins", "parameters", "controls", "goals" } do
    e[key] = journal.list(e[key])
  end
  for _, key in ipairs { "cost", "contact", "solver_libraries" } do e[key] = e[key] == nil and json.null or e[key] end
  command_line.print_json(journal.encode(e, json))
end

local function explain(o)
  local e, message = hooke.explain(o.path, o.given, { trust = o.trust })
  if not e then return fail(message) end
  e.contact = contact_advice(e, o)
  if o.json then
    print_json(e)
  else
    print_loaded(e)
    print_solver(e)
    print_steps(e)
    print_contact(e)
    print_warnings(e)
  end
  return 0
end

-- ---- the cost of its parts ----

local function progress()
  local process = require("process")
  if not process.terminal(2) then return nil end
  return function(done, total)
    io.stderr:write(("\rcost: run %d of %d %s"):format(done, total, done == total and "\r\27[K" or ""))
  end
end

-- Prints what was found -> the study as plain data; nil: what is wrong has been said.
local function study_of(o)
  local report = require("common.cost.cost_report")
  local study, message = require("common.cost.cost").study { scene = o.path, params = o.given, integrator = o.integrator,
    ["until"] = o.until_, trust = o.trust, repeats = o.repeats, tick = progress() }
  if not study then return fail(message) and nil end
  if not o.json then report.print(study) end
  return report.plain(study)
end

-- Says where the diagram is, or why there is none.
local function draw(o, study)
  local out = o.out or "out/cost/" .. o.path:match("([^/]+)$"):gsub("%.lua$", "")
  local made, refused = files.make_folder(out)
  if not made then return fail(refused) end
  local absent, why = require("common.cost.cost_diagram").draw(out .. "/cost", study)
  if not absent then return fail(why) end
  print(("\nwrote %s/cost.png and cost.svg%s"):format(out,
    #absent > 0 and "; without what did not run to an end: " .. table.concat(absent, ", ") or ""))
end

-- In a process of its own, which the scene cannot leave; what draws is a program beside it.
local function explain_cost(o)
  local process = require("process")
  io.stdout:flush()
  local pid, fd = process.fork()
  if pid == 0 then
    if not o.trust then hooke.confine(o.path) end
    local study = study_of(o)
    io.stdout:flush()
    if study then process.write(fd, json.encode(study)) end
    process.exit(study and 0 or 1)
  end
  local parts = {}
  repeat
    parts[#parts + 1] = process.read(fd)
  until parts[#parts] == ""
  process.close(fd)
  process.wait(pid)
  local text = table.concat(parts)
  if text == "" then return 1 end
  if o.json then
    command_line.print_json(text)
  else
    draw(o, json.decode(text))
  end
  return 0
end

local o = parse()
if not o then return 1 end
if o.cost then return explain_cost(o) end
if not o.trust then hooke.confine(o.path) end
return explain(o)
