-- A journal of a tool's results, written line by line (JSON): after an interruption the same command continues from it.
-- A journal belongs to a fingerprint of everything that the results depend on; with another fingerprint a new one is
-- begun. Long strings (packed states) are stored in files of their own beside it.
local files = require("common.run.file")
local json = require("cjson").new()
json.encode_invalid_numbers(true)
json.decode_invalid_numbers(true)
json.encode_sparse_array(true)

local journal = {}
local store = {}
store.__index = store

-- FNV-1a of 64 bits (Fowler, Noll and Vo), as 16 hexadecimal digits.
function journal.hash(text)
  local h = 0xcbf29ce484222325
  for k = 1, #text do h = (h ~ text:byte(k)) * 0x100000001b3 end
  return ("%016x"):format(h)
end

function journal.read(path)
  local file = io.open(path, "rb")
  if not file then return nil end
  local text = file:read("a")
  file:close()
  return text
end

-- A text of a table that is equal for equal contents.
function journal.canonical(value)
  if type(value) ~= "table" then return math.type(value) == "float" and ("%.17g"):format(value) or tostring(value) end
  local keys, parts = {}, {}
  for key in pairs(value) do keys[#keys + 1] = key end
  table.sort(keys, function(a, b) return tostring(a) < tostring(b) end)
  for _, key in ipairs(keys) do parts[#parts + 1] = tostring(key) .. "=" .. journal.canonical(value[key]) end
  return "{" .. table.concat(parts, ",") .. "}"
end

-- The text of a script and of every file beside it, or in scripts/lib, that it names in quotes: modules, meshes, start
-- states.
local function texts_of(path, seen, texts)
  local folder = path:match("^(.*/)") or ""
  local text = hooke.read(path, folder == "" and "." or folder, hooke.library)
  if seen[path] or not text then return texts end
  seen[path] = true
  texts[#texts + 1] = text
  if not path:find("%.lua$") then return texts end
  for word in text:gmatch("[\"']([^\"'\n]+)[\"']") do
    local module = word:gsub("%.", "/") .. ".lua"
    texts_of(folder .. word, seen, texts)
    texts_of(folder .. module, seen, texts)
    if hooke.library then texts_of(hooke.library .. "/" .. module, seen, texts) end
  end
  return texts
end

-- The scene's text and the files it names, its parameters, and the contents of the installed plugins.
function journal.of_scene(path, params)
  local sums = {}
  for k, plugin in ipairs((hooke.catalogue())) do sums[k] = ("%s %s"):format(plugin.path, hooke.checksum(plugin.path)) end
  local parts = texts_of(path, {}, {})
  parts[#parts + 1] = journal.canonical(params)
  parts[#parts + 1] = hooke.version .. table.concat(sums, "\n")
  return journal.hash(table.concat(parts, "\0"))
end

local function states_path(self, key) return ("%s.%s"):format(self.path, journal.hash(key)) end

-- Reads the rows of an earlier run; those of another fingerprint are deleted with their files.
local function resume(self, text, fingerprint)
  local stranger = false
  for line in text:gmatch("[^\n]+") do
    local fine, row = pcall(json.decode, line)
    if not fine then return end -- the last line is incomplete
    stranger = stranger or row.fingerprint and row.fingerprint ~= fingerprint
    if row.key and stranger then
      if row.result.kept then os.remove(states_path(self, row.key)) end
    elseif row.key then
      self.known[row.key] = row.result
      self.count = self.count + 1
    end
  end
end

-- Returns nil and the reason where it cannot be written; what it held is still there then.
function journal.open(path, fingerprint)
  local self = setmetatable({ path = path, known = {}, count = 0 }, store)
  resume(self, journal.read(path) or "", fingerprint)
  local lines = { json.encode { fingerprint = fingerprint } }
  for key, result in pairs(self.known) do lines[#lines + 1] = json.encode { key = key, result = result } end
  local fine, why = files.write(path, table.concat(lines, "\n") .. "\n")
  if not fine then return nil, why end
  self.file, why = io.open(path, "ab")
  return self.file and self, why
end

-- The stored result with its states, or nil.
function store:get(key)
  local kept, result = self.known[key], {}
  if not kept or not kept.kept then return kept end
  local text, at = journal.read(states_path(self, key)), 1
  if not text then return nil end
  for name, value in pairs(kept) do result[name] = value end
  result.states = {}
  while at <= #text do result.states[#result.states + 1], at = string.unpack("<s8", text, at) end
  return result
end

-- What cannot be written is not taken up after an interruption; self.failed says why.
function store:put(key, result)
  local kept = {}
  for name, value in pairs(result) do kept[name] = value end
  if result.states then
    local parts = {}
    for k, state in ipairs(result.states) do parts[k] = string.pack("<s8", state) end
    local fine, why = files.write(states_path(self, key), table.concat(parts))
    if not fine then
      self.failed = why
      return
    end
    kept.states, kept.kept = nil, true
  end
  self.known[key] = kept
  local fine, why = self.file:write(json.encode { key = key, result = kept }, "\n")
  if fine then fine, why = self.file:flush() end
  if not fine then self.failed = ("cannot write %s: %s"):format(self.path, why) end
end

-- Removes the journal, when all is done.
function store:remove()
  self.file:close()
  for key, result in pairs(self.known) do
    if result.kept then os.remove(states_path(self, key)) end
  end
  os.remove(self.path)
end

journal.json = json

-- cjson writes an empty table as {}: this text stands for a list without members until it is written.
local none = "\0no members\0"

-- A member of what journal.encode writes that is a list, also where it is empty.
function journal.list(list) return #list > 0 and list or none end

-- `by`: an encoder of cjson with settings of its own.
function journal.encode(value, by) return ((by or json).encode(value):gsub('"\\u0000no members\\u0000"', "[]")) end

local function without_null(value)
  if value == json.null then return nil end
  if type(value) ~= "table" then return value end
  local copy = {}
  for key, item in pairs(value) do copy[key] = without_null(item) end
  return copy
end

-- What a text of JSON says, for scripts, which have no null: such members are left out. Or nil where it is none.
function journal.decode(text)
  local fine, value = pcall(json.decode, text)
  if fine then return without_null(value) end
end

return journal
