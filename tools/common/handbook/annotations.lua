-- The language of scenes for editors: a file of annotations that Lua's language server reads (LuaCATS), so that scenes are
-- completed and checked while they are written.
local plugin_types = require("common.handbook.plugin_types")
local reference = require("common.handbook.reference")

local annotations = {}

local classes = { scene = "hooke.Scene", run = "hooke.Run", handle = "hooke.Handle", state = "hooke.State", rigid = "hooke.Rigid",
  joint = "hooke.Joint" }

-- The type of what an entry gives, by how its words begin.
local types = {
  { "^a scene", "hooke.Scene" }, { "^a run", "hooke.Run" }, { "^a state", "hooke.State" }, { "^a rigid body", "hooke.Rigid" },
  { "^a joint", "hooke.Joint" }, { "^a handle", "hooke.Handle" }, { "^a function", "function" }, { "^its id", "integer" },
  { "^an id", "integer" }, { "^a list of ids", "integer[]" }, { "^{", "number[]" },
  { "^a table", "table" }, { "^parameters of", "table" }, { "^edges$", "integer[][]" }, { "^triangles$", "integer[][]" },
  { "^tetrahedra$", "integer[][]" }, { "^a number or a list", "number|number[]" }, { "^a list, N$", "number[]" },
  { "^four ids", "integer[]" }, { "^the value$", "number|string|boolean" }, { "^J$", "number" }, { "^kg$", "number" },
  { "^s$", "number" }, { "^rad", "number" }, { "^m$", "number" }, { "^a text", "string" }, { "^a number$", "number" },
}

local function type_of(gives)
  if not gives then return nil end
  for _, k in ipairs(types) do
    if gives:find(k[1]) then return k[2] end
  end
  return "any"
end

-- The type of a key of a table: what its row says, or by its name, its default, or how its text begins; "any" where that leaves it open.
local of_names = { nx = "integer", ny = "integer", nz = "integer", n = "integer", count = "integer", knots = "integer", threads = "integer",
  duration = "number", fps = "number", dt = "number", tol = "number", width = "number", height = "number", depth = "number",
  group = "string", file = "string", help = "string", measure = "string" }
local vectors = { from = "m", to = "m", origin = "m", position = "m", velocity = "m/s", low = "m", high = "m" } -- in these units
local of_texts = { { "^a list of ids", "integer[]" }, { "^a list", "table" }, { "^a function", "function" }, { "^the name", "string" },
  { "^a direction", "number[]" }, { "^its lower corner", "number[]" }, { "^its upper corner", "number[]" } }

local function key_type(row)
  if row.type then return row.type end
  local default = tostring(row.default or "")
  if default == "true" or default == "false" then return "boolean" end
  if row.text:find(" or ") then return of_names[row.name] or "any" end
  for _, k in ipairs(of_texts) do
    if row.text:find(k[1]) then return k[2] end
  end
  if vectors[row.name] == row.unit then return "number[]" end
  return of_names[row.name] or "any"
end

local function options_of(name) return "hooke." .. name:gsub("[^%w]+", "_") .. "_options" end

-- The keys of the table that an entry takes, as a class of their own.
local function options(entry, out)
  out[#out + 1] = "---@class " .. options_of(entry.name)
  for _, row in ipairs(entry.takes) do
    if row.name ~= "CHANNEL" then
      out[#out + 1] = ("---@field %s%s %s # %s%s"):format(row.name, row.default == "required" and "" or "?", key_type(row),
        row.unit ~= "-" and row.unit .. "; " or "", row.text)
    end
  end
  out[#out + 1] = ""
end

-- The arguments between the parentheses of the form, by name; a table is `options`.
local function arguments(entry)
  local inside = entry.form:match("^[%w_:.]+%((.*)%)") or (entry.takes and "{}" or "")
  inside = inside:gsub("%b{}", entry.takes and "options" or "place"):gsub("function%b() .- end", "f"):gsub("function%b().-end", "f")
  local names = {}
  for word in inside:gmatch("[^,]+") do
    local name = word:match("[%a_][%w_]*") or "value"
    if name == "or" or name == "end" or name == "function" then name = "value" end
    names[#names + 1] = name == names[#names] and name .. "_2" or name
  end
  if entry.takes and names[#names] ~= "options" and not inside:find("options") then names[#names + 1] = "options" end
  return names
end

-- The type of an argument by its name, and of some functions by their entry.
local of_arguments = { name = "string", help = "string", label = "string", file = "string", id = "integer", i = "integer", j = "integer",
  k = "integer", state = "hooke.State", f = "function", grid = "hooke.Handle", ids = "integer|integer[]|hooke.Handle",
  default = "number|string|boolean" }
local of_functions = { ["scene:measure"] = "fun(state: hooke.State): number", ["scene:cost"] = "fun(state: hooke.State): number",
  ["scene:on_frame"] = "fun(state: hooke.State)" }

local function argument_type(entry, argument, last)
  if last then return options_of(entry.name) end
  if argument == "f" and of_functions[entry.name] then return of_functions[entry.name] end
  if argument:find("^place") then return entry.form:find("{ parameter = value", 1, true) and "table" or "number[]" end
  return of_arguments[argument] or "any"
end

local function method(entry, plugins, out)
  local of, sign, name = entry.name:match("^(%w+)([:.])([%w_]+)$")
  local owner = classes[of] or of
  if of == "hooke" and not entry.form:find("[{(]") then return end
  if sign == "." and of ~= "hooke" then return end -- fields stand in the class
  out[#out + 1] = "--- " .. entry.text
  local names = arguments(entry)
  for k, argument in ipairs(names) do
    local last = k == #names and argument == "options" and entry.takes
    out[#out + 1] = ("---@param %s%s %s"):format(argument, k > 1 and "?" or "", argument_type(entry, argument, last))
  end
  local gives = type_of(entry.gives)
  if gives then out[#out + 1] = "---@return " .. gives .. " # " .. entry.gives end
  if of == "scene" then plugin_types.overloads(plugins, name, gives, out) end
  out[#out + 1] = ("function %s%s(%s) end\n"):format((of and of ~= "hooke" and owner:gsub("%.", "_") .. ":" or of and "hooke." or ""),
    name or entry.name, table.concat(names, ", "))
end

-- plugins: hooke.catalogue().
function annotations.text(plugins)
  local out = { "---@meta", "-- The language of hooke's scenes; made by `hooke docs`.", "", "hooke = {}", "" }
  for _, entry in ipairs(reference.all()) do
    if entry.takes then options(entry, out) end
  end
  for _, plugin in ipairs(plugins) do plugin_types.lines(plugin, out) end
  local names = {}
  for name in pairs(classes) do names[#names + 1] = name end
  table.sort(names)
  for _, name in ipairs(names) do
    out[#out + 1] = "---@class " .. classes[name]
    if name == "state" then out[#out + 1] = "---@field t number # s\n---@field n integer # particles" end
    out[#out + 1] = ("local %s = {}\n"):format(classes[name]:gsub("%.", "_"))
  end
  for _, entry in ipairs(reference.all()) do method(entry, plugins, out) end
  return table.concat(out, "\n")
end

return annotations
