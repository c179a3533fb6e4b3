-- The commands that problems of `hooke validate` ask for: `hooke optimise` and `hooke fit` on a script and data that the problem
-- writes. They run as a user's do, the script in its own sandbox; of their options those are let that neither write nor trust.
local files = require("common.run.file")
local journal = require("common.bench.journal")

local tool_runs = {}

local commands = { optimise = true, fit = true }
local lets = { goal = true, by = true, at = true, starts = true, refine = true, most = true, tolerance = true, accuracy = true,
  dt = true, integrator = true, seed = true }

local function quoted(word) return "'" .. word:gsub("'", "'\\''") .. "'" end

-- { command =, script =, data =, words = } as a line for the shell, in the folder; or nil and what is wrong.
local function line_of(asks, folder)
  if type(asks) ~= "table" or not commands[asks.command] or type(asks.script) ~= "string" then
    return nil, "asks: expected { command = \"optimise\" or \"fit\", script = a scene's text, words = { ... } }"
  end
  local list = { "/proc/$PPID/exe", asks.command, quoted(folder .. "/scene.lua"), "--json", "--quiet", "--out",
    quoted(folder .. "/out") }
  if asks.command == "fit" then list[#list + 1] = "--no-diagrams" end
  if asks.data then table.move({ "--data", quoted(folder .. "/data.csv") }, 1, 2, #list + 1, list) end
  for _, word in ipairs(asks.words or {}) do
    local option = tostring(word):match("^%-%-?([^=]*)")
    if option and not tonumber(word) and not lets[option] then return nil, ("asks: the option %s is not let"):format(word) end
    list[#list + 1] = quoted(tostring(word))
  end
  return table.concat(list, " ") .. " 2>" .. quoted(folder .. "/said")
end

local function run_in(folder, asks)
  local line, why = line_of(asks, folder)
  if not line then return nil, why end
  local fine
  fine, why = files.write(folder .. "/scene.lua", asks.script)
  if fine and asks.data then fine, why = files.write(folder .. "/data.csv", asks.data) end
  if not fine then return nil, why end
  local pipe = io.popen(line)
  local text = pipe:read("a")
  pipe:close()
  local found = journal.decode(text)
  if type(found) == "table" then return found end
  local file = io.open(folder .. "/said")
  local said = file and file:read("a") or ""
  if file then file:close() end
  return nil, ("hooke %s: %s"):format(asks.command, said:match("([^\n]+)") or "it printed no result")
end

-- In the process of a case with `asks`, one request or a list of them: { found = a result or a list }, or { failed }.
function tool_runs.execute(case)
  local list, found, failed = case.asks[1] and case.asks or { case.asks }, {}, nil
  local folder = os.tmpname()
  os.remove(folder)
  local made, why = files.make_folder(folder)
  if not made then return { failed = why } end
  for k, asks in ipairs(list) do
    found[k], failed = run_in(folder, asks)
    if failed then break end
  end
  os.execute("rm -rf " .. quoted(folder))
  if failed then return { failed = failed } end
  return { found = case.asks[1] and found or found[1] }
end

return tool_runs
