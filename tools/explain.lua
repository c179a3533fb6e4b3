-- hooke explain SCENE.lua [name=value ...]: prints the plugins that will be loaded, sizes, stiffness, and the stable
-- step per integrator. With --cost: the cost and the effect of each force, constraint, corrector and source
-- (common/cost/cost.lua).
local command_line = require("common.run.command_line")
local json = require("cjson").new()
json.encode_invalid_numbers("null")

local function fail(message) return command_line.complain("explain", message) end

-- ---- the command line ----

local kinds = { cost = "flag", json = "flag", trust = "flag", integrator = "text", ["until"] = "number",
  repeats = "count" }
local needs_cost = { "integrator", "until", "repeats" }

local function value_of(kind, text)
  local number = tonumber(text)
  if kind == "text" then return text end
  if kind == "number" then return number and number > 0 and number < math.huge and number or nil end
  return number and math.tointeger(number) and number >= 1 and math.tointeger(number) or nil
end

-- "--name", "--name value" or "--name=value" at word k: the name, its value and the number of words; or nil and the
-- reason.
local function option_at(k)
  local name, joined = arg[k]:match("^%-%-(%w+)=?(.*)$")
  local kind = kinds[name]
  if not kind then return nil end
  if kind == "flag" then return name, true, 1 end
  local has_joined = arg[k]:find("=", 1, true)
  local text = has_joined and joined or arg[k + 1]
  local value = text and value_of(kind, text)
  if not value then return nil, ("--%s: '%s' is not %s"):format(name, text or "", kind == "text" and "a name"
    or kind == "count" and "a whole number above 0" or "a positive number") end
  return name, value, has_joined and 1 or 2
end

local function parse()
  local o, k = { given = {} }, 1
  while k <= #arg do
    local name, value = arg[k]:match("^([%a_][%w_]*)=(.*)$")
    local option, found, used = option_at(k)
    if name then o.given[name], used = value, 1
    elseif option then o[option] = found
    elseif found then return nil, found
    elseif arg[k]:sub(1, 1) == "-" or o.path then
      return nil, ("'%s' is neither the scene nor name=value, nor one of --cost, --json, --trust, --integrator NAME, "
        .. "--until SECONDS, --repeats N"):format(arg[k])
    else o.path, used = arg[k], 1 end
    k = k + used
  end
  if not o.path then return nil, "no scene given: hooke explain SCENE.lua [name=value ...] [--cost]" end
  for _, option in ipairs(needs_cost) do
    if o[option] and not o.cost then return nil, ("--%s goes with --cost"):format(option) end
  end
  return o
end

-- ---- the scene ----

local function seconds(x)
  return x ~= x and "not known" or x == math.huge and "any" or x == 0 and "none" or ("%.4g s"):format(x)
end

local function print_loaded(e)
  print(("%s: %d particles (%d pinned), %d triangles, %.4g kg; state %.3g MB"):format(e.scene, e.particles, e.pinned,
    e.triangles, e.mass, e.state_bytes / 1e6))
  print(("%g s at %g frames a second with %s"):format(e.duration, e.fps, e.integrator))
  print("\nloaded")
  for _, p in ipairs(e.plugins) do
    print(("  %-11s %-14s %-16s %s"):format(p.kind, p.name, p.label, p.edges and ("%d edges"):format(p.edges) or ""))
  end
end

local function print_solver(e)
  if e.solver_libraries then print(("\nlinear systems\n  %s"):format(e.solver_libraries)) end
end

local function print_warnings(e)
  for k, warning in ipairs(e.warnings) do print((k == 1 and "\n" or "") .. "warning: " .. warning) end
end

local function print_steps(e)
  local s = e.spectrum
  print("\nlinearised at the start")
  print(("  frequencies up to   %.4g 1/s (a period of %.4g s)"):format(s.w_max,
    s.w_max > 0 and 2 * math.pi / s.w_max or math.huge))
  print(("  damping rates up to %.4g 1/s; of every mode at least %.3g + %.3g w^2"):format(s.g_max, s.alpha, s.beta))
  if s.b_max > 0 then print(("  velocities turn at up to %.4g 1/s"):format(s.b_max)) end
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

local function explain(o)
  local e, message = hooke.explain(o.path, o.given, { trust = o.trust })
  if not e then return fail(message) end
  if o.json then
    print(json.encode(e))
  else
    print_loaded(e)
    print_solver(e)
    print_steps(e)
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

local function explain_cost(o)
  local report = require("common.cost.cost_report")
  local study, message = require("common.cost.cost").study { scene = o.path, params = o.given, integrator = o.integrator,
    ["until"] = o["until"], trust = o.trust, repeats = o.repeats, tick = progress() }
  if not study then return fail(message) end
  if o.json then
    print(json.encode(report.plain(study)))
  else
    report.print(study)
  end
  return 0
end

local o, message = parse()
if not o then return fail("explain: " .. message) end
if not o.trust then hooke.confine(o.path) end
return (o.cost and explain_cost or explain)(o)
