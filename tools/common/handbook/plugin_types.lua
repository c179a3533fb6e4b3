-- The parameters of plugins as annotations (LuaCATS): a class of each plugin's table, and an overload of the function that takes
-- it, so that an editor completes the names of plugins and parameters and checks the values.
local plugin_entry = require("common.handbook.plugin_entry")

local plugin_types = {}

local tuples = "integer[]|integer[][]"

-- What scripts give for a type of the catalogue; by a function of t: what may be one.
local types = {
  number = { "number", "number|fun(t: number): number" },
  integer = { "integer" },
  boolean = { "boolean" },
  string = { "string" },
  vector = { "number[]", "number[]|fun(t: number): number, number, number" },
  numbers = { "number[]" },
  particles = { "integer|integer[]" },
  edges = { tuples }, triangles = { tuples }, tetrahedra = { tuples },
  ["per tuple"] = { "number|number[]|fun(...: number): number" },
  ["function"] = { "function" },
}

local function choice(text)
  local words = {}
  for word in text:gmatch("[^|]+") do words[#words + 1] = ('"%s"'):format(word) end
  return table.concat(words, "|")
end

-- The type of a parameter; a timed one may be a function of t as well.
function plugin_types.of(p)
  if p.type == "choice" then return choice(p.text) end
  local known = assert(types[p.type], p.type)
  return p.timed and known[2] or known[1]
end

function plugin_types.class(plugin)
  return ("hooke.%s.%s"):format(plugin.kind, plugin.name:gsub("[^%w_]", "_"))
end

-- What all plugins of a kind take beside their own.
local common = {
  force = { "label? string # its name in outputs", "only? integer|integer[] # ids of the particles that it acts on",
    "group? string # that it acts on", "from? number # s; it acts from then on", "to? number # s; until then" },
}

local function one_line(text) return (text:gsub("%s+", " ")) end

-- The class of the table that the plugin takes, line by line.
function plugin_types.lines(plugin, out)
  local taken = {}
  out[#out + 1] = ("--- %s"):format(one_line(plugin.summary))
  out[#out + 1] = ("---@class %s"):format(plugin_types.class(plugin))
  for _, p in ipairs(plugin.params) do
    local notes = {}
    for _, note in ipairs { p.unit, p.help, plugin_entry.range(p), "default " .. plugin_entry.default(p) } do
      if note ~= "" then notes[#notes + 1] = note end
    end
    taken[p.name] = true
    out[#out + 1] = ("---@field %s%s %s # %s"):format(p.name, p.required and "" or "?", plugin_types.of(p),
      one_line(table.concat(notes, "; ")))
  end
  for _, line in ipairs(common[plugin.kind] or {}) do
    if not taken[line:match("^[%w_]+")] then out[#out + 1] = "---@field " .. line end
  end
  out[#out + 1] = ""
end

-- The forms of scene:force and its like, one for each plugin of the kind.
function plugin_types.overloads(plugins, kind, gives, out)
  for _, plugin in ipairs(plugins) do
    if plugin.kind == kind then
      out[#out + 1] = ('---@overload fun(self: hooke.Scene, name: "%s", parameters?: %s)%s'):format(plugin.name,
        plugin_types.class(plugin), gives and ": " .. gives or "")
    end
  end
end

return plugin_types
