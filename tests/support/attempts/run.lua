-- Runs attempts of untrusted scenes to get out of their sandbox, to crash hooke or to keep it from ending. Each is a line
-- of the files beside this one:
--   { what it tries, scene = text of the script, ... }
-- It runs in a folder of its own, beside a folder "outside" that it may neither read nor change, by `hooke run`. Held is
-- an attempt when hooke ends by itself, within ten seconds of a processor, with one of its exit codes, "outside" is as it
-- was, nothing loaded escape.so (tests/fixtures/escape.c, which leaves a file), and nothing printed the secret. Further
-- keys:
--   says     the output holds this text; without it, and without `any`, any error message
--   any      the output does not matter
--   hides    the output does not match this pattern
--   args, command, name, setup   arguments, another command than run, the script's file name, a command of the shell before
--   environment  variables, for export
--   interrupt    SIGINT comes after a second, and the run ends by it
--   memory       KiB of address space that it may have (not with sanitizers, which need more)
--   json, csv    the output is JSON; the first record of measures.csv
--   same, twice  two runs say the same; a run alone and one after scene:run{} give the same answer
--   patch        goes on from a checkpoint in which this is wrong
--   within       nothing is written beside the folder
local files = require("files")

local build = os.getenv("HK_BUILD") or "build"
local seconds, patience, grace = 10, 600, 10 -- s: of a processor; of a machine however busy; after an interrupt
local own_codes = { [0] = true, true, true, true, true, true, [130] = true }
local sanitized = build:find("sanitize") ~= nil

local function shell(command)
  local pipe = assert(io.popen(command .. " 2>&1"))
  local text = pipe:read("a")
  local _, how, code = pipe:close()
  return text, how == "signal" and 128 + code or code
end

local quoted, write, read = files.quoted, files.write, files.read

local place = shell("mktemp -d /tmp/hooke-attempts-XXXXXX"):gsub("%s", "")
local outside = place .. "/outside"

local function make_outside()
  shell(("rm -rf %s/*; mkdir -p %s/deep %s/work; cp %s/tests/fixtures/escape.so %s/work/"):format(place, outside, place, build,
    place))
  write(outside .. "/secret", "TOP-SECRET = 1\n")
  write(outside .. "/secret.lua", "TOP-SECRET = 1\n")
  write(outside .. "/victim", "untouched\n")
  write(outside .. "/deep/only", "untouched\n")
end

local function state_of_outside()
  return (shell(("cd %s && find outside -printf '%%p %%y\\n' -type f -exec cksum {} + | sort"):format(place)))
end

local untouched -- the state of what make_outside makes
local function state_before(t)
  if t.setup then return state_of_outside() end
  untouched = untouched or state_of_outside()
  return untouched
end

-- ---- checkpoints that are wrong ----

local function checksum(text)
  local h = 1469598103934665603
  for k = 1, #text do h = (h ~ text:byte(k)) * 1099511628211 end
  return string.pack("<I8", h & 0xffffffffffffffff)
end

local mass, dt = 0.7310585786300049, 0.0123456789

local function replace(text, from, to)
  local at, count = 1, 0
  while true do
    local found = text:find(from, at, true)
    if not found then return text, count end
    text, at, count = text:sub(1, found - 1) .. to .. text:sub(found + #from), found + #from, count + 1
  end
end

local patches = {
  group = function(text) return replace(text, string.pack("<I4d", 0, mass), string.pack("<I4d", 77777777, mass)) end,
  dt = function(text) return replace(text, string.pack("<d", dt), string.pack("<d", 0)) end,
}

local function checkpoint_scene(t, patch)
  local scene = ([[
local s = hooke.scene { duration = 0.1, fps = 10, dt = %.17g, integrator = "leapfrog" }
s:particle { mass = %.17g }
s:force("gravity")
]]):format(dt, mass)
  write(place .. "/work/save.lua", scene .. 's:run { to = 0.05 }:save("c")')
  local said, code = shell(("cd %s/work && %s/hooke run save.lua --trust --quiet"):format(place, build))
  if code ~= 0 then error("no checkpoint was written: " .. said) end
  local text = read(place .. "/work/c")
  local head = text:match("^[^\n]*\n")
  local body, count = patches[patch](text:sub(#head + 1, -9))
  if count == 0 then error("the checkpoint has nothing to patch") end
  write(place .. "/work/c", head .. body .. checksum(body))
  t.scene = scene .. 's:start { file = "c" }\nreturn s'
end

-- ---- one attempt ----

local function fill(text)
  return (text:gsub("@%u+@", { ["@HERE@"] = place .. "/work", ["@OUTSIDE@"] = outside, ["@PLUGINS@"] = build .. "/plugins",
    ["@FIXTURES@"] = build .. "/tests/fixtures" }))
end

local function command_of(t)
  local name = t.name or "scene.lua"
  local command, words = (t.command or "run"):match("^(%S+)(.*)$")
  local limit = ("ulimit -t %d; "):format(seconds)
  if t.memory and not sanitized then limit = limit .. ("ulimit -v %d; "):format(t.memory) end
  if t.environment then limit = limit .. "export " .. fill(t.environment) .. "; " end
  local timeout = t.interrupt and ("timeout -s INT -k %d 1"):format(grace) or ("timeout -k %d %d"):format(grace, patience)
  return ("cd %s/work && %s%s %s/hooke %s ./%s %s%s </dev/null"):format(place, limit, timeout, build, command, quoted(name),
    t.args or "", words)
end

local function prepare(t)
  make_outside()
  if t.patch then checkpoint_scene(t, t.patch) end
  write(place .. "/work/" .. (t.name or "scene.lua"), fill(t.scene))
  if t.setup then
    local said, code = shell(("cd %s/work && { %s; }"):format(place, fill(t.setup)))
    assert(code == 0, said)
  end
end

local function strict_json(text)
  local fine, json = pcall(require, "cjson")
  local begin = text:find("{", 1, true)
  return utf8.len(text) and (not fine or pcall(json.decode, text:sub(begin or 1)))
end

local function answer_of(t, scene)
  make_outside()
  write(place .. "/work/scene.lua", scene)
  local text = shell(command_of { command = t.command, args = "--json --state final.csv --no-output" })
  return text:match('"verdict":"(%w+)"'), read(place .. "/work/final.csv")
end

local function complaint(t)
  prepare(t)
  local before = state_before(t)
  local listing = t.within and shell("ls -A " .. place)
  local said, code = shell(command_of(t))
  local ended = t.interrupt and (code == 124 and 130 or code) or code
  if code == 137 or code == 152 or code == 124 and not t.interrupt then return "it did not end within 10 s", said end
  local broken = said:find("Sanitizer", 1, true) or said:find("runtime error:", 1, true) or said:find("SIG%u+,")
  if not own_codes[ended] or broken then
    return "it crashed", said
  end
  if shell(("find %s -name ESCAPED"):format(place)) ~= "" then return "native code ran, or a file was written", said end
  if said:find("TOP-SECRET", 1, true) then return "the secret was shown", said end
  if state_of_outside() ~= before then return "the folder outside was changed", said end
  if t.within and shell("ls -A " .. place) ~= listing then return "something was written beside the folder", said end
  if t.hides and said:find(t.hides) then return ("it shows what matches %s"):format(("%q"):format(t.hides)), said end
  local unconfined = sanitized or said:find("this kernel has", 1, true) -- which it says
  local silent = t.says and not said:find(t.says, 1, true)
  if silent and not (unconfined and t.environment) then return ("it does not say '%s'"):format(t.says), said end
  if not t.any and not t.twice and not t.interrupt and not said:find("hooke:", 1, true) then return "it says nothing", said end
  if t.memory and said:find("no memory", 1, true) then return "only the system's limit ended it", said end
  if t.json and not strict_json(said) then return "that is no JSON", said end
  if t.csv and (read(place .. "/work/out/measures.csv") or ""):sub(1, #t.csv + 1) ~= t.csv .. "\n" then
    return "measures.csv begins otherwise", read(place .. "/work/out/measures.csv")
  end
  if t.same and shell(command_of(t)) ~= said then return "two runs differ", said end
  if t.twice then
    local v1, s1 = answer_of(t, t.scene)
    local v2, s2 = answer_of(t, (t.scene:gsub("s:run%(%)\n", "")))
    if v1 ~= v2 or s1 ~= s2 or not s1 then return ("other answers: %s and %s"):format(v1, v2), (s1 or "") .. (s2 or "") end
  end
end

-- Runs the attempts of the themes (files beside this one), those whose name contains `only`, and of these every so many;
-- returns whether all held.
return function(themes, only, every)
  local met, count, wrong = 0, 0, 0
  io.stdout:setvbuf("line")
  for _, theme in ipairs(themes) do
    for _, t in ipairs(require("attempts." .. theme)) do
      local needs_confinement = t.environment and sanitized -- such builds are not confined
      local meant = t[1]:find(only or "", 1, true) and not needs_confinement
      met = met + (meant and 1 or 0)
      if meant and (met - 1) % (every or 1) == 0 then
        count = count + 1
        local why, said = complaint(t)
        if why then
          wrong = wrong + 1
          print(("FELL  %s: %s: %s"):format(theme, t[1], why))
          for line in ((said or ""):sub(1, 600) .. "\n"):gmatch("([^\n]+)\n") do print("      | " .. ("%q"):format(line)) end
        end
      end
    end
  end
  shell("rm -rf " .. quoted(place))
  print(("%d attempts, %d fell"):format(count, wrong))
  return wrong == 0
end
