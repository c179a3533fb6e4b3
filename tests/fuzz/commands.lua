-- Random command lines: commands, options and values in any order; see tests/support/fuzz/run.lua.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
local run = require("fuzz.run")
local values = require("fuzz.values")
local chance, pick = values.chance, values.pick

local scene = [[
local k = param("k", 10, "stiffness", { min = 0 })
local s = hooke.scene { duration = 0.02, fps = 50, integrator = "leapfrog" }
local h = s:strand { n = 3, from = { 0, 0, 0 }, to = { 1, 0, 0 } }
s:force("springs", { edges = h:structural(), k = k })
s:measure("x", function(state) return state:position(2)[1] end)
return s
]]

local commands = { "run", "run", "run", "run", "run", "plugins", "explain", "new", "check", "bench", "stability", "auto",
  "--version", "--help",
  "help", "--cflags", "nope", "", "../run", "run/../run", "-", "--", "keep", "\\255" }

-- Options whose value is a number, a name or a file, and those without.
local numeric = { "--dt", "--tol", "--accuracy", "--until", "--threads", "--seed", "--budget", "--target", "--seconds",
  "--jobs", "--finest" }
local named = { "--integrator", "--solver", "--accuracy-at", "--state", "--out", "--integrators", "--metric", "--only",
  "--scene" }
local flags = { "--json", "--quiet", "--no-output", "--verify", "--trust", "--help", "--cost", "--hard", "--nope", "-h", "-",
  "--", "-x", "=", "a=b" }

local numbers = { "0", "1", "-1", "0.01", "1e-3", "nan", "inf", "-inf", "1e400", "5e-324", "1e308", "0x10", "1e", "", " ", "1 ",
  " 1", "1,2", "2000",
  "18446744073709551616", "-0", "+1", "1024", "3", "٣" }
local words = { "leapfrog", "rk4", "xpbd:substeps=3", "xpbd:substeps=", "xpbd:=3", "xpbd:substeps=3,,", "xpbd:nope=1",
  "xpbd:substeps=nan", ":", "",
  "auto", "pcg", "pcg:tolerance=1e-3", "pcg:tolerance=x", "cholmod", "./x.so", "../x", "/", ".", "frames", "end", "springs",
    "scene.lua", "f.csv",
  "none/f.csv", "/dev/full", "/dev/null", "x\\ny", "%s%n", "\\033[2J", "x=y", "gravity", "bdf2:tolerance=0,iterations=-1",
    "force", "solver" }
local params = { "k=5", "k=", "k=x", "k=nan", "k=-1", "k=1e999", "=5", "k=5=6", "kk=1", "k=0x10", "k=true", "k= 5", "k=5 k=6",
  "\\xff=1" }

local function quoted(text) return ("\"$(printf '%%b' '%s')\""):format(text:gsub("%%", "%%%%")) end

local function word()
  local how = math.random(6)
  if how == 1 then return ("%s %s"):format(pick(numeric), quoted(pick(numbers))) end
  if how == 2 then return ("%s=%s"):format(pick(numeric), quoted(pick(numbers))) end
  if how == 3 then return ("%s %s"):format(pick(named), quoted(pick(words))) end
  if how == 4 then return pick(flags) end
  if how == 5 then return pick(params):find(" ") and "k=5" or quoted(pick(params)) end
  return chance(0.3) and quoted(pick(words)) or ""
end

-- What they take as their first argument.
local first = { plugins = { "", "springs", "nope" }, new = { "force x", "force ''", "nope x", "output ../x", "force 'a b'", "",
  "force" },
  check = { "springs", "nope", "scene.lua", "/dev/null", "." }, stability = { "--help", "scene.lua --help" },
  bench = { "--help", "scene.lua --budget 0.1 --target x", "none.lua" }, auto = { "", "scene.lua", "--help" } }

local found = {
  { "a command that is no text", words = "\"$(printf '\\377\\033')\"", code = 1, says = "unknown command '\\xff\\x1b'",
    files = {} },
  { "a plugin's name that is no text", words = "plugins \"$(printf '\\033[2J')\"", code = 1, says = "no plugin '\\x1b[2J'",
    files = {} },
  { "a number that is none, of bench", words = "bench scene.lua --target x", code = 1,
    says = "bench: --target: 'x' is not a positive number", files = {} },
  { "an option that auto has not", words = "auto scene.lua --nope", code = 1, says = "hooke: auto: unknown option '--nope'",
    files = {} },
}

run.fuzz {
  name = "commands",
  found = found,
  cases = 40,
  make = function()
    local command = pick(commands)
    local list = { quoted(command), first[command] and pick(first[command]) or chance(0.95) and "scene.lua" or "" }
    for _ = 1, math.random(0, 4) do list[#list + 1] = word() end
    return { files = { ["scene.lua"] = scene }, words = table.concat(list, " ") }
  end,
}
