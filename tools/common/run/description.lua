-- A script in the place of a command line: return hooke.fit { scene = "a.lua", data = "a.csv", by = { "k" } }. It runs in the
-- sandbox of scenes (hooke.definition); its fields are the options of the tool, whose checks they pass, and what the command line
-- says is in their place. Its function `found`, if it has one, gets the result, in the sandbox again, and may make scenes and run
-- them; what it returns is printed and stands in the JSON as `answer`.
local case_process = require("common.run.case_process")
local command_line = require("common.run.command_line")
local journal = require("common.bench.journal")

local description = {}

local answers = "found"

local function sorted(names)
  local list = {}
  for name in pairs(names) do list[#list + 1] = name end
  table.sort(list, function(a, b) return tostring(a) < tostring(b) end)
  return list
end

local function text_of(value)
  return math.type(value) == "float" and ("%.17g"):format(value) or tostring(value)
end

local function is_plain(value) return type(value) == "number" or type(value) == "string" end

-- ---- fields as words: each gives words of a command line, or nil and what is wrong ----

local fields = {}

function fields.option(key, value)
  if not is_plain(value) then return nil, "expected a number or a text" end
  return { ("--%s=%s"):format(key, text_of(value)) }
end

-- A list of texts.
function fields.list(key, value)
  local words = {}
  if type(value) == "string" then value = { value } end
  for k, name in ipairs(type(value) == "table" and value or {}) do
    if type(name) ~= "string" then return nil, "expected a list of names" end
    words[k] = ("--%s=%s"):format(key, name)
  end
  if #words == 0 then return nil, "expected a list of names" end
  return words
end

-- { "k", c = 0.3, d = { 1, 0, 5 } }: names, some with a start, or a start and bounds.
function fields.parameters(key, value)
  if type(value) == "string" then value = { value } end
  if type(value) ~= "table" then return nil, "expected { \"k\", c = START, d = { START, LOW, HIGH } }" end
  local words = {}
  for k, name in ipairs(value) do words[k] = ("--%s=%s"):format(key, tostring(name)) end
  for _, name in ipairs(sorted(value)) do
    local numbers = type(value[name]) == "table" and value[name] or { value[name] }
    if type(name) == "string" then
      local list = {}
      for k, x in ipairs(numbers) do list[k] = text_of(x) end
      words[#words + 1] = ("--%s=%s=%s"):format(key, name, table.concat(list, ":"))
    end
  end
  return words
end

-- { x = 1, v = 0 }: measures and the numbers that they shall be.
function fields.numbers(key, value)
  if type(value) ~= "table" then return nil, "expected { NAME = NUMBER }" end
  local words = {}
  for k, name in ipairs(sorted(value)) do
    if type(name) ~= "string" or type(value[name]) ~= "number" then return nil, "expected { NAME = NUMBER }" end
    words[k] = ("--%s=%s=%s"):format(key, name, text_of(value[name]))
  end
  return words
end

-- { name = value } of the scene.
function fields.params(_, value)
  if type(value) ~= "table" then return nil, "expected { name = value }" end
  local words = {}
  for k, name in ipairs(sorted(value)) do
    if type(name) ~= "string" or not name:match("^[%a_][%w_]*$") or type(value[name]) == "table" then
      return nil, "expected { name = value }"
    end
    words[k] = ("%s=%s"):format(name, text_of(value[name]))
  end
  return words
end

local function beside(folder, value) return value:sub(1, 1) == "/" and value or folder .. "/" .. value end

function fields.scene(_, value, folder)
  if type(value) ~= "string" then return nil, "expected the path of a scene, from the script's folder" end
  return { beside(folder, value) }
end

-- A file in the script's folder or below: what is wrong with its lines is printed, and others' files are none of a script's.
function fields.data(key, value, folder, trust)
  if type(value) ~= "string" then return nil, "expected the path of a table, from the script's folder" end
  local path = beside(folder, value)
  local text, why = nil, nil
  if not trust then text, why = hooke.read(path, folder, folder) end
  if not (trust or text) then return nil, why end
  return { ("--%s=%s"):format(key, path) }
end

-- ---- scripts ----

local function check_keys(name, tool, kinds, d)
  for key in pairs(d) do
    if key ~= answers and not kinds[key] then
      local near = hooke.nearest(tostring(key), sorted(kinds))
      return nil, ("%s: hooke.%s{} has no field '%s'; %s"):format(name, tool, tostring(key),
        near and ("did you mean '%s'?"):format(near) or "it has " .. table.concat(sorted(kinds), ", "))
    end
  end
  if d[answers] ~= nil and d[answers] ~= true then return nil, ("%s: %s: expected a function"):format(name, answers) end
  if d.scene == nil then return nil, ("%s: hooke.%s{} names no scene: scene = \"FILE.lua\""):format(name, tool) end
  return true
end

-- The words of the fields of d but those that o, the command line, has in lists of its own.
local function words_of(path, tool, kinds, d, o)
  local name, folder, all = path:match("[^/]*$"), path:match("^(.*)/[^/]*$") or ".", {}
  local fine, why = check_keys(name, tool, kinds, d)
  if not fine then return nil, why end
  for _, key in ipairs(sorted(d)) do
    local own = type(o[key]) == "table" and key ~= "scene" and #o[key] > 0
    if key ~= answers and not own then
      local words
      words, why = fields[kinds[key]](key, d[key], folder, o.trust)
      if not words then return nil, ("%s: %s: %s"):format(name, key, why) end
      table.move(words, 1, #words, #all + 1, all)
    end
  end
  return all
end

-- Whether the text of a script describes a run of the tool rather than a scene.
function description.names(text, tool) return text:find("hooke%s*%.%s*" .. tool .. "%f[^%w_]") ~= nil end

-- The first word that is no name=value, if that file describes a run of the tool.
local function described(tool, words)
  for _, word in ipairs(words) do
    if not word:match("^[%a_][%w_]*=") then
      local file = io.open(word, "rb")
      local text = file and file:read("a")
      if file then file:close() end
      return text and description.names(text, tool) and word
    end
  end
end

-- The options of a tool from its command line, and where that names a script with hooke.TOOL{} from there too. make_parser() gives a
-- parser; kinds: { field = "option", "list", "parameters", "numbers", "params", "scene" or "data" }. Returns the options, with
-- o.described, the script, and o.answers, whether it has `found`; or nil and what is wrong, or nil where that has been said.
function description.parse(tool, make_parser, kinds)
  local o = command_line.parse(tool, make_parser())
  local path = o and described(tool, o.scene)
  if not path then return o end
  local d, why = hooke.definition(path, tool, answers)
  if not d then return nil, why end
  local words
  words, why = words_of(path, tool, kinds, d, o)
  if not words then return nil, why end
  o = command_line.parse(tool, make_parser(), table.move(arg, 1, #arg, #words + 1, words))
  if not o then return nil end
  for k = #o.scene, 1, -1 do
    if o.scene[k] == path then table.remove(o.scene, k) end
  end
  o.out = o.out or ("out/%s/%s"):format(tool, path:match("([^/]+)$"):gsub("%.lua$", ""))
  o.described, o.answers = path, d[answers]
  return o
end

-- What the script's `found` says of the result, a text of JSON; nil where there is none; or nil and why it fails. `best` of what it
-- gets is the first of the list of that name.
function description.answer(tool, o, text, list)
  if not o.answers then return nil end
  local result = journal.decode(text)
  result.best = result[list][1]
  local case = { scene = o.described, result = result }
  function case.execute()
    local answer, why = hooke.ask(o.described, answers, result, { threads = 1, within = tool })
    return { answer = answer, why = answer == nil and type(why) == "string" and why or nil }
  end
  local got = case_process.run(case)
  return got.answer, got.why or got.failed
end

-- The answer as lines for people.
function description.lines(answer)
  if type(answer) ~= "table" then return { "  " .. text_of(answer) } end
  local lines = {}
  for k, name in ipairs(sorted(answer)) do
    local value = answer[name]
    lines[k] = ("  %-16s %s"):format(tostring(name), type(value) == "number" and ("%.9g"):format(value)
      or type(value) == "table" and journal.json.encode(value) or tostring(value))
  end
  return lines
end

return description
