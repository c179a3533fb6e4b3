-- The language of scenes as a list of entries: { name, form, gives, text, takes = { { name, type, unit, default, text } }, example },
-- in the order of the handbook. The type, of annotations (LuaCATS), stands behind the name where its text does not say it: "mass: number".
local reference = {}

reference.parts = {
  { title = "Scripts and scenes", entries = require("common.handbook.scenes") },
  { title = "Builders", entries = require("common.handbook.builders") },
  { title = "Handles, states, bodies, joints", entries = require("common.handbook.objects") },
}

local function parsed(text)
  local rows = {}
  for line in text:gmatch("[^\n]+") do
    local name, unit, default, what = line:match("^(.-) | (.-) | (.-) | (.*)$")
    local plain, of = assert(name, line):match("^([%w_]+): (.+)$")
    rows[#rows + 1] = { name = plain or name, type = of, unit = unit, default = default, text = what }
  end
  return rows
end

for _, part in ipairs(reference.parts) do
  for _, entry in ipairs(part.entries) do
    if type(entry.takes) == "string" then entry.takes = parsed(entry.takes) end
  end
end

-- All entries, part by part.
function reference.all()
  local list = {}
  for _, part in ipairs(reference.parts) do table.move(part.entries, 1, #part.entries, #list + 1, list) end
  return list
end

-- The entries that a word names: "scene:grid", or "grid".
function reference.find(word)
  local found = {}
  for _, entry in ipairs(reference.all()) do
    if entry.name == word or entry.name:match("[%w_]+$") == word then found[#found + 1] = entry end
  end
  return found
end

-- An entry as lines of text.
function reference.lines(entry)
  local lines = { entry.form .. (entry.gives and (": gives %s"):format(entry.gives) or ""), "  " .. entry.text }
  for _, row in ipairs(entry.takes or {}) do
    lines[#lines + 1] = ("  %-12s %-10s default %-14s %s"):format(row.name, row.unit, row.default, row.text)
  end
  if entry.example and entry.example ~= "" then lines[#lines + 1] = "  example: " .. entry.example end
  return lines
end

return reference
