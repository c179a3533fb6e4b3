-- The command line of hooke sweep: one table of options drives parsing and help.
local description = require("common.run.description")
local lfs = require("lfs")
local plan = require("common.sweep.plan")
local ranges = require("ranges")
local script = require("common.sweep.script")

local command = {}

-- { name, placeholder of the value, help, type of the value (default: text), largest value }
local options = {
  { "--integrators", "LIST", "of integrators: leapfrog,rk4,xpbd:substeps=10" },
  { "--dt", "VALUES", "of steps, s" },
  { "--tol", "VALUES", "of tolerances" },
  { "--until", "S", "end there instead of at the scene's duration", "number" },
  { "--measures", "LIST", "the measures to show and write" },
  { "--repeats", "N", "each case so often, with seeds in a row", "whole" },
  { "--seed", "N", "of samples and of runs", "whole" },
  { "--verify", nil, "each run is checked by one with half the step" },
  { "-j", "N", "cases at a time (default: the processors)", "whole", 256 },
  { "--timeout", "S", "a case that takes longer is ended and recorded so", "number" },
  { "--db", "FILE", "the database (default out/sweep/NAME.db)" },
  { "--resume", nil, "go on: what is done is not done again" },
  { "--again", nil, "do everything again" },
  { "--retry", nil, "go on, and do again what crashed or timed out" },
  { "--report", nil, "what is done so far; runs nothing" },
  { "--csv", "FILE", "write the results as CSV" },
  { "--plot", "Y:X[,Z]", "draw Y against X (a line for each of the rest), or as colour over X and Z", "list" },
  { "--linear", nil, "beside the spread of samples that by gradients of the measures" },
  { "--print-cases", nil, "print the cases, one a line, and run none" },
  { "--case", "K", "run these only: 7 or 1-20 or 3,5,9-12; done ones are not done again" },
  { "--part", "FILE", "write what --case does to a database of its own (for --merge)" },
  { "--merge", "FILE", "take over what FILE holds, and run nothing", "list" },
  { "--slurm", nil, "run as a Slurm job array" },
  { "--tasks", "N", "of the array (default: as many as 100)", "whole", 100000 },
  { "--sbatch", "OPTIONS", "further options of sbatch, as one text" },
  { "--wait", nil, "until the array has ended" },
  { "--trust", nil, "lift the scenes' sandbox" },
  { "--quiet", nil, "no progress and no table" },
  { "--help", nil, "this text" },
}

function command.help()
  print("hooke sweep SWEEP.lua [options]\nhooke sweep SCENE.lua name=values ... [options]\n")
  print("values: 16,32,64   1e2..1e6:log:9   0..1:linear:5   0..1:random:50   9..11:normal:50   1..1e4:latin:log:50   16..64:log:5:whole")
  print()
  for _, o in ipairs(options) do print(("  %-13s %-9s %s"):format(o[1], o[2] or "", o[3])) end
end

local function option_named(word)
  local names = {}
  for k, o in ipairs(options) do
    if o[1] == word then return o end
    names[k] = o[1]
  end
  plan.unknown("option", word, names)
end

local function convert(o, text)
  if o[4] ~= "number" and o[4] ~= "whole" then return text end
  local value = tonumber(text)
  if o[4] == "whole" then value = value and math.tointeger(value) end
  if not value or o[5] and (value < 1 or value > o[5]) then
    plan.refuse("%s: '%s' is not a %s%s", o[1], text, o[4] == "whole" and "whole number" or "number",
      o[5] and (" from 1 to %d"):format(o[5]) or "")
  end
  return value
end

local function is_same(one, other)
  local a, b = lfs.attributes(one), lfs.attributes(other)
  if a and b then return a.mode == "file" and a.dev == b.dev and a.ino == b.ino end
  return not a and not b and one:gsub("^%./+", "") == other:gsub("^%./+", "")
end

-- What is written is neither the sweep nor written twice.
local function refuse_the_same_file(asked)
  local csv, db = asked.given["--csv"], asked.given["--db"]
  if csv and db and is_same(csv, db) then plan.refuse("--csv: %s is the file of --db as well; name another file", csv) end
  for _, option in ipairs { "--csv", "--db", "--part" } do
    local path = asked.given[option]
    if path and asked.path and is_same(path, asked.path) then
      plan.refuse("%s: %s is what is to be run; name another file", option, path)
    end
  end
end

-- The values of a parameter or an option, which its errors name.
local function values_of(name, text)
  local fine, found = pcall(ranges.parse, text)
  if not fine then plan.refuse("%s: %s", name, found) end
  return found
end

-- The arguments after "hooke sweep" -> { path, params = { name = values }, given = { [option] = value } }
function command.parse(arguments)
  local asked, k = { params = {}, given = {} }, 1
  while k <= #arguments do
    local name, values = arguments[k]:match("^([%w_]+)=(.*)$")
    if name then
      asked.params[name] = values_of(name, values)
    elseif arguments[k]:sub(1, 1) == "-" then
      local word = arguments[k]:match("^%-j%d+$") and "-j" or arguments[k]
      local o = option_named(word)
      local value = true
      if o[2] then
        value = word ~= arguments[k] and arguments[k]:sub(3) or arguments[k + 1]
        if not value then plan.refuse("%s: a value is missing: %s %s", o[1], o[1], o[2]) end
        if word == arguments[k] then k = k + 1 end
        value = convert(o, value)
      end
      if o[4] == "list" then
        asked.given[o[1]] = asked.given[o[1]] or {}
        table.insert(asked.given[o[1]], value)
      else
        asked.given[o[1]] = value
      end
    elseif asked.path then
      plan.refuse("'%s' is neither the sweep nor name=values nor an option", arguments[k])
    else
      asked.path = arguments[k]
    end
    k = k + 1
  end
  refuse_the_same_file(asked)
  return asked
end

-- "a:x=1,y=2,b" -> { "a:x=1,y=2", "b" }: a piece with "=" belongs to the one before.
local function methods(text)
  local list = {}
  for piece in text:gmatch("[^,]+") do
    if piece:match("^[%w_]+=") and #list > 0 then list[#list] = list[#list] .. "," .. piece
    else list[#list + 1] = piece end
  end
  return list
end

local function words_of(text)
  local list = {}
  for word in text:gmatch("[^,]+") do list[#list + 1] = word end
  return list
end

-- The sweep's definition: the script's, or that of a single scene, with the replacements of the command line.
function command.define(asked)
  local file, why = io.open(asked.path)
  local text = file and file:read("a")
  if not text then plan.refuse("cannot read %s", why or asked.path) end
  file:close()
  local given = asked.given
  local d = description.names(text, "sweep") and script.read(asked.path) or { scene = asked.path, folder = "." }
  d.params = d.params or {}
  for name, values in pairs(asked.params) do d.params[name] = values end
  d.integrators = given["--integrators"] and methods(given["--integrators"]) or d.integrators
  d.dt = given["--dt"] and values_of("--dt", given["--dt"]) or d.dt
  d.tol = given["--tol"] and values_of("--tol", given["--tol"]) or d.tol
  d.measures = given["--measures"] and words_of(given["--measures"]) or d.measures
  for _, name in ipairs { "until", "repeats", "seed", "timeout", "verify", "trust" } do
    if given["--" .. name] ~= nil then d[name] = given["--" .. name] end
  end
  d.jobs = given["-j"] or d.jobs
  d.name = tostring(d.name or asked.path:match("([^/]*)$"):gsub("%.lua$", "")):gsub("[^%w_.-]+", "-")
  return d
end

return command
