-- Random scripts that call what scenes have, in any order and with values of any type; see tests/support/fuzz/run.lua. The
-- names of plugins and of their parameters come from hooke's own catalogue.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
local run = require("fuzz.run")
local catalogue = require("fuzz.catalogue")
local values = require("fuzz.values")
local chance, pick = values.chance, values.pick

local plugins
local kinds = { "force", "force", "force", "constraint", "corrector", "source", "integrator", "solver", "output", "service" }

-- ---- tables of settings ----

local function field(list, key, text, p)
  if chance(p or 0.5) then list[#list + 1] = ("%s = %s"):format(key, text) end
end

local function braces(list)
  if chance(values.strangeness) then list[#list + 1] = pick { "1", "nope = 1", "[2] = 3", "[{}] = 1", "label = 7" } end
  return ("{ %s }"):format(table.concat(list, ", "))
end

local function settings_of(plugin)
  local list = {}
  for _, p in ipairs(plugin.params) do field(list, p.name, values.of(p), p.required and 1 or 0.4) end
  return list
end

local function choice(kind)
  local plugin = pick(plugins[kind])
  if chance(0.1) then return "'auto'" end
  if chance(0.5) then return ("'%s'"):format(plugin.name) end
  return ("{ '%s', %s }"):format(plugin.name, table.concat(settings_of(plugin), ", "))
end

-- ---- statements ----

local made = {}

function made.scene()
  local list = {}
  field(list, "duration", values.number(0, 0.2), 0.95)
  field(list, "fps", values.number(5, 60), 0.9)
  field(list, "dt", values.number(0.001, 0.05), 0.4)
  field(list, "tol", values.number(1e-8, 1e-2), 0.1)
  field(list, "accuracy", values.number(1e-6, 1e-1), 0.2)
  field(list, "accuracy_at", values.or_strange(pick { "'end'", "'frames'" }), 0.1)
  field(list, "seed", values.whole(0, 9), 0.2)
  field(list, "threads", values.whole(0, 3), 0.1)
  field(list, "integrator", choice("integrator"), 0.6)
  field(list, "solver", choice("solver"), 0.3)
  return ("s = hooke.scene %s"):format(braces(list))
end

local groups = { "'a'", "'b'", "'all'" }

function made.particle()
  local list = {}
  field(list, "position", values.vector(2), 0.9)
  field(list, "velocity", values.vector(2))
  field(list, "mass", values.number(0.1, 2))
  field(list, "group", values.or_strange(pick(groups)), 0.2)
  field(list, "heat", values.number(0, 2), 0.03)
  return ("p = s:particle %s"):format(braces(list))
end

function made.particles()
  local places, speeds = {}, {}
  for k = 1, math.random(0, 5) do places[k], speeds[k] = values.vector(2), values.vector(2) end
  local list = { ("positions = { %s }"):format(table.concat(places, ", ")) }
  field(list, "velocities", ("{ %s }"):format(table.concat(speeds, ", ")))
  field(list, "mass", values.number(0.1, 2))
  field(list, "masses", "{ 1, 2, 3 }", 0.1)
  field(list, "group", values.or_strange(pick(groups)), 0.2)
  return ("h = s:particles %s"):format(braces(list))
end

function made.grid()
  local list = { "nx = " .. values.whole(1, 5), "ny = " .. values.whole(1, 5) }
  for _, key in ipairs { "width", "height", "mass" } do field(list, key, values.number(0.1, 2)) end
  for _, key in ipairs { "origin", "u", "v" } do field(list, key, values.vector(2), 0.2) end
  field(list, "group", values.or_strange(pick(groups)), 0.2)
  return ("h = s:grid %s\ne = h:edges()"):format(braces(list))
end

function made.strand()
  local list = { "n = " .. values.whole(2, 7) }
  field(list, "from", values.vector(2))
  field(list, "to", values.vector(2))
  field(list, "length", values.number(0.1, 2))
  field(list, "direction", values.vector(2))
  field(list, "mass", values.number(0.1, 2))
  return ("h = s:strand %s\ne = h:structural()"):format(braces(list))
end

function made.mesh()
  local list = { "file = " .. values.or_strange(pick { "'mesh.obj'", "'mesh.obj'", "'none.obj'", "'scene.lua'", "'.'" }) }
  field(list, "scale", values.number(0.1, 2))
  field(list, "origin", values.vector(2), 0.2)
  field(list, "mass", values.number(0.1, 2))
  return ("h = s:mesh %s\ne = h:flexion()"):format(braces(list))
end

local function blobs()
  local list = {}
  for k = 1, math.random(0, 3) do
    list[k] = ("{ %s, %s, %s, radius = %s }"):format(values.number(-1, 1), values.number(-1, 1), values.number(-1, 1),
      values.number(0.1, 1))
  end
  return ("{ %s }"):format(table.concat(list, ", "))
end

function made.implicit()
  local list, parts = { "size = " .. values.number(0.2, 0.6) }, { ("{ blobs = %s }"):format(blobs()),
    "{ f = function(x, y, z) return 1 - x*x - y*y - z*z end }", values.strange() }
  field(list, "f", values.or_strange(pick { "function(x, y, z) return 1 - x*x - y*y - z*z end", "function(x) return x end",
    "function() return s end", "function(x) return s:particle {} end", "function() end", "print" }), 0.4)
  field(list, "blobs", values.or_strange(blobs()), 0.4)
  field(list, pick { "union", "intersection", "difference" }, ("{ %s, %s }"):format(pick(parts), pick(parts)), 0.3)
  field(list, "level", values.number(-1, 1), 0.2)
  field(list, "inside", values.or_strange(pick { "'above'", "'below'" }), 0.2)
  field(list, "blend", values.number(0, 1), 0.1)
  field(list, "box", values.or_strange(("{ %s, %s }"):format(values.vector(2), values.vector(2))), 0.3)
  field(list, "box", "{ { -2, -2, -2 }, { 2, 2, 2 } }", 0.5)
  field(list, "as", values.or_strange(pick { "'body'", "'solid'", "'surface'" }), 0.5)
  field(list, "method", values.or_strange(pick { "'cubes'", "'tetrahedra'" }), 0.3)
  field(list, "close", values.or_strange("true"), 0.3)
  field(list, "coarse", values.whole(0, 9), 0.2)
  field(list, "mass", values.number(0.1, 2), 0.5)
  return ("h = s:implicit %s\nr = s:within(%s, %s)"):format(braces(list), values.vector(2), values.vector(2))
end

function made.plugin()
  local kind = pick(kinds)
  local plugin = pick(plugins[chance(0.97) and kind or pick(kinds)])
  local list = settings_of(plugin)
  field(list, "label", values.or_strange(pick { "'first'", "'second'", "'sp ace'", "'µ'" }), 0.2)
  if kind ~= "force" then return ("s:%s('%s', %s)"):format(kind, plugin.name, values.or_strange(braces(list))) end
  field(list, "only", values.or_strange(pick { "h", "h:ids()", "{ 1 }", "{ 2, 1, 1 }", "p" }), 0.1)
  field(list, "group", values.or_strange(pick(groups)), 0.1)
  field(list, "from", values.number(0, 0.1), 0.1)
  field(list, "to", values.number(0, 0.2), 0.1)
  field(list, "fastest", values.number(0.001, 0.1), 0.05)
  return ("s:%s('%s', %s)"):format(kind, plugin.name, values.or_strange(braces(list)))
end

function made.pin()
  local ids = values.or_strange(pick { "{ 1 }", "{ 1, 2 }", "{ h:at(1) }", "h:ids()", "h", "1", "{}", "{ p }" })
  local list = {}
  field(list, "path", pick { "function(t) return t, 0, 0 end", "function(t) return 0, t*t, 0, 0, 2*t, 0 end",
    "function() return { 1, 2, 3 } end", values.strange() }, 0.3)
  field(list, "axes", values.vector(1), 0.15)
  field(list, "normal", values.vector(1), 0.15)
  field(list, "release", values.number(0, 0.2), 0.2)
  field(list, "fastest", values.number(0.001, 0.1), 0.05)
  return ("s:pin(%s, %s)"):format(ids, braces(list))
end

function made.channel()
  local list = {}
  field(list, "size", values.whole(1, 3), 0.3)
  field(list, "initial", pick { "1", "{ 1 }", "{ 1, 2 }", "{ 1, 2, 3 }", values.strange() })
  field(list, "rate", pick { "-1", "100", "function(t, id, y) return -y end", "function(t, id, a, b) return a, b end",
    "'springs'", values.strange() })
  field(list, "accuracy", values.number(1e-4, 1), 0.1)
  return ("s:channel(%s, %s)"):format(values.or_strange(pick { "'heat'", "'dye'", "'x'", "''", "'mass'", "'position'" }),
    braces(list))
end

local questions = { "position(%s)", "velocity(%s)", "mass(%s)", "channel('heat', %s)", "ids()", "energy()", "kinetic()",
  "potential()", "force('first', %s)", "force('gravity', %s)", "strain('springs')", "strain()", "channel(%s, %s)" }

local function question(of)
  return ("%s:%s"):format(of, pick(questions):gsub("%%s", function() return values.or_strange("1") end))
end

local function looks()
  return pick { question("state") .. "[1]", question("state"), "state.t", "state.n", values.strange(), "#state:ids()" }
end

function made.measure()
  return ("s:measure(%s, function(state) return %s end)"):format(values.or_strange(pick { "'m'", "'n'", "'a,b'", "''" }), looks())
end

function made.on_frame() return ("s:on_frame(function(state) local _ = %s end)"):format(looks()) end

function made.exact()
  return ("s:exact(%s)"):format(values.or_strange("function(t) return t, 0, 0 end"))
end

function made.start() return ("s:start { file = %s }"):format(values.or_strange(pick { "'state.csv'", "'none'",
  "'scene.lua'" })) end

function made.run()
  return ("r = s:run { %s }\n%s\nlocal sum = r:summary() string.format('%%s', sum.verdict)"):format(chance(0.7) and "to = " ..
    values.number(0, 0.1) or "", pick { "p = r:state():ids()[1]", "local _ = " .. question("r:state()"), "r:save('c')",
      "r:packed()" })
end

function made.parameter()
  return ("p = param(%s, %s, %s)"):format(values.or_strange(pick { "'k'", "'N'" }), values.or_strange("1"),
    values.or_strange("'help'"))
end

function made.handle()
  return ("local _ = h:%s(%s)"):format(pick { "at", "ids", "edges", "structural", "shear", "flexion", "triangles" },
    pick { "", "1", "1, 2", values.strange() })
end

function made.edges()
  return pick { "e = e .. h:edges()", "e = e .. {{1, 2}}", "local _ = #e, e[1], e[#e + 1]", "e = h:structural() + e",
    ("local _ = e[%s]"):format(values.strange()), ("e = e .. %s"):format(values.strange()), "e = { e, { 1, 2 }, e }" }
end

function made.periodic()
  local list = {}
  field(list, "low", values.vector(-3), 0.5)
  field(list, "high", values.vector(8), 0.95)
  field(list, "axes", values.or_strange(pick { "'x'", "'xy'", "'xyz'", "'zz'", "''" }), 0.5)
  return ("s:periodic(%s)"):format(values.or_strange(braces(list)))
end

-- A method with the wrong arguments, or of the wrong object.
function made.odd()
  local name = pick { "force", "pin", "grid", "measure", "run", "particle", "channel", "start", "exact", "mesh", "nope" }
  return ("%s.%s(%s, %s)"):format(pick { "s", "h", "e", "hooke.scene {}" }, name, values.strange(), values.strange())
end

local likely = { "particle", "particle", "particles", "grid", "grid", "strand", "plugin", "plugin", "plugin", "plugin", "plugin",
  "plugin", "plugin", "plugin", "plugin", "pin", "pin", "channel", "measure", "measure", "on_frame", "exact", "start", "run",
    "parameter",
  "handle", "edges", "odd", "mesh", "implicit", "scene", "periodic" }

-- ---- a script ----

local head = [[
local s, h, e, r, p
local knot, deep, meta = {}, {}, setmetatable({}, { __index = function() return 1 end })
knot[1], knot[2] = knot, knot
for _ = 1, 30 do deep = { deep } end
]]

-- Bare: the first error ends it. Caught: it goes on behind every error. Inside: it is called in a coroutine.
local function statement(text, how)
  if how == "bare" then return text end
  local call = how == "caught" and "pcall(%s)" or "coroutine.wrap(%s)()"
  return call:format(("function()\n%s\nend"):format(text))
end

local function script()
  local how, lines = pick { "bare", "bare", "caught", "caught", "inside" }, { head, made.scene(), made[pick { "grid",
    "strand" }]() }
  values.strangeness = pick { 0, 0, 0.003, 0.01, 0.03 }
  if chance(0.5) then lines[4] = "s:force('gravity', { g = { 0, 0, -9.81 } })" end
  if chance(0.5) then lines[#lines + 1] = "s:force('springs', { edges = h:structural(), k = 50 })" end
  for _ = 1, math.random(0, 8) do lines[#lines + 1] = statement(made[pick(likely)](), how) end
  lines[#lines + 1] = "return " .. values.or_strange("s")
  return table.concat(lines, "\n") .. "\n"
end

local options = { "", "", "--json", "--quiet", "--no-output", "--verify", "--accuracy 1e-3", "--dt 0.01", "--threads 2",
  "--state final.csv",
  "--integrator bdf2", "--integrator dopri5", "--solver pcg", "--trust", "--seed 3", "--until 0.01",
  "--integrator rk4", "--integrator xpbd" }

local function one(text)
  return { ["scene.lua"] = "local s = hooke.scene { duration = 0.1, fps = 10, integrator = 'leapfrog' }\n" .. text }
end

local found = {
  { "explain, where forces are not finite at the start", words = "explain scene.lua", code = 1, says = "forces are not finite",
    files = one "s:particle { position = { 9, 0, 0 } }\ns:force('central', { strength = 1e300, power = 20 })\nreturn s" },
  { "a label that cannot be seen", words = "run scene.lua", code = 1, says = "gravity: label: expected a text that is not empty",
    files = one "s:particle {}\ns:force('gravity', { label = '' })\nreturn s" },
  { "a row beyond 32 bits", words = "run scene.lua", code = 1, says = "at(8589934593) is outside 1 to 2",
    files = one "s:strand { n = 2 }:at(2^33 + 1)" },
  { "frames that cannot be counted, which were blamed on the integrator", words = "run scene.lua", code = 1,
    says = "1e+308 frames a second are too many", files = one "hooke.scene { duration = 0.1, fps = 1e308 }" },
  { "more columns than there may be", words = "run scene.lua", code = 1,
    says = "2000000 is not a whole number from 1 to a million",
    files = one "s:grid { nx = 2e6, ny = 1 }" },
}

run.fuzz {
  name = "scenes",
  found = found,
  cases = 50,
  prepare = function() plugins = catalogue.read(run.before .. run.hooke) end,
  make = function()
    values.strangeness = 0.01
    local tool = chance(0.05) and "explain" or "run"
    local words = tool == "run" and ("--until 0.1 %s %s"):format(pick(options), pick(options)) or ""
    if tool == "run" and chance(0.005) then words = "--integrator auto --accuracy 0.1" end
    return {
      files = { ["scene.lua"] = script(), ["mesh.obj"] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.1\nf 1 2 3\nf 2 4 3\n",
        ["state.csv"] = "id,x,y,z,vx,vy,vz,mass\n1,0,0,0,0,0,0,1\n2,1,0,0,0,0,0,1\n" },
      words = ("%s scene.lua %s"):format(tool, words),
    }
  end,
}
