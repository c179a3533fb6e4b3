-- What scripts/sweeps/README.md and scripts/validation/README.md show can be pasted: every line of their blocks of commands,
-- and their scripts. The scenes that they name are small ones here, `...` in a script is an answer of its own, and lists of
-- problems take the place of hours. tests/long/slurm.sh has --slurm.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
local files = require("files")

local pipe = assert(io.popen("mktemp -d /tmp/hooke-readme-XXXXXX"))
local folder = pipe:read("l")
pipe:close()

-- The code, and what was said.
local function shell(command)
  local words = ("cd %s && hooke() { %s/hooke \"$@\"; } && { %s; } >said 2>&1 </dev/null"):format(files.quoted(folder),
    files.quoted(build), command)
  local _, how, code = os.execute(words)
  return how == "exit" and code or 128 + code, files.read(folder .. "/said")
end

local function succeeds(command)
  local code, said = shell(command)
  assert(code == 0, ("%s: exit %d: %s"):format(command, code, said))
  return said
end

local function blocks_of(name, kind)
  local list = {}
  for of, text in files.read(root .. "/" .. name):gmatch("\n```(%a*)\n(.-)\n```") do
    if of == kind then list[#list + 1] = text end
  end
  assert(#list > 0, name .. ": no block is found")
  return list
end

-- The commands of a file, without what is said beside them; returns their number.
local function each_command(name, try)
  local count = 0
  for _, block in ipairs(blocks_of(name, "")) do
    for line in (block .. "\n"):gmatch("(.-)\n") do
      local command = line:gsub("%s+#.*$", "")
      if command:find("%S") then
        assert(command:find("^hooke "), name .. ": no command: " .. line)
        count = count + 1
        try(command)
      end
    end
  end
  return count
end

local cloth = [[
local k, N = param("k", 100), param("N", 4)
local scene = hooke.scene { duration = 0.1, fps = 10, dt = 0.05 }
scene:particle { position = { 0, 0, k / N }, mass = 1 }
scene:measure("sag", function(s) return s:position(1)[3] end)
return scene
]]

succeeds("mkdir -p scripts/sweeps scripts/scenes")
succeeds(("ln -s %s scripts/lib"):format(files.quoted(root .. "/scripts/lib")))
files.write(folder .. "/scene.lua", cloth)
files.write(folder .. "/scripts/scenes/cloth.lua", cloth)

-- ---- sweeps ----

files.write(folder .. "/s.lua", 'return hooke.sweep { scene = "scene.lua", params = { k = { 1, 2, 3, 4 } } }\n')
local sweeps = each_command("scripts/sweeps/README.md", function(command)
  if command:find("--slurm", 1, true) then return end
  if command:find("scripts/sweeps/", 1, true) then
    command = command:gsub("scripts/sweeps/", root .. "/%0") .. " --print-cases"
  end
  if command:find("--merge", 1, true) then succeeds("hooke sweep s.lua --case 4 --part host2.db") end
  succeeds((command:gsub("1%-500", "1-3"):gsub("parallel hooke (.-) {}", "xargs -n 1 " .. build .. "/hooke %1")))
end)
assert(succeeds("wc -l <sag.csv"):find("^55"), "the first sweep has not its 54 cases")
for k, block in ipairs(blocks_of("scripts/sweeps/README.md", "lua")) do
  files.write(("%s/scripts/sweeps/block%d.lua"):format(folder, k), block .. "\n")
  local said = succeeds(("hooke sweep scripts/sweeps/block%d.lua --case 1-4"):format(k))
  assert(not said:find("hooke:", 1, true), said)
end

-- ---- validation ----

local exact = "local period = 2 * (1 + 0.01 / at.n ^ 2 + 0.01 * at.h ^ 2)" -- of the order 2 that the script expects
for _, block in ipairs(blocks_of("scripts/validation/README.md", "lua")) do
  files.write(folder .. "/my_problem.lua", (block:gsub("%.%.%.%s+%-%- any scene[^\n]*", exact)) .. "\n")
end
local problems = each_command("scripts/validation/README.md", function(command)
  command = command:gsub("%./mine%.so", build .. "/plugins/forces/springs.so")
  local one = command:find("kepler", 1, true)
  if not command:find("my_problem", 1, true) then command = command .. (one and " --quick" or " --list") end
  succeeds(command)
end)

os.execute("rm -rf " .. files.quoted(folder))
print(("%d commands of sweeps, %d of validation"):format(sweeps, problems))
assert(sweeps >= 7 and problems >= 8, "the commands are not found")
