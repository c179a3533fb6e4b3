-- What a page shares with pictures and recordings (plugins/common/frame_data, plugins/common/colour), as data: the maps of
-- colours, the colours of things, the kinds of solids, how thick things are drawn, and how the fields of a frame are shown.
local page = require("page")
local json_text = require("common.view.json_text")

local shared = {}

local all = page.shared()

-- Forces within bodies are kept as channels whose names end with their units.
local function name_and_unit(f)
  local name, unit = f.name:match("^(%S+) (%S+)$")
  if f.kind == "channel" and (unit == "N" or unit == "N/m" or unit == "Pa") then return name:gsub("_", " "), unit end
  return f.name
end

-- A field of a frame, { kind =, name =, components = }, as a page has it.
function shared.field(f)
  local kind, own = all.fields[f.kind], f.kind ~= f.name
  local label, unit = name_and_unit(f)
  return { name = own and f.kind .. " " .. f.name or f.name, label = f.kind == "force" and "force: " .. f.name or label,
    components = f.components, unit = unit or kind.unit, painted = kind.painted, map = kind.map }
end

-- For the data of a page, whose packed text `out` takes.
function shared.page_data(out)
  local maps = {}
  for name, packed in pairs(all.maps) do maps[name] = out:add(packed) end
  local things = {}
  for name, colour in pairs(all.things) do things[name] = json_text.list(colour) end
  local groups = json_text.list()
  for k, colour in ipairs(all.groups) do groups[k] = json_text.list(colour) end
  local radii = {}
  for name, value in pairs(all.radii) do radii[name] = type(value) == "table" and json_text.list(value) or value end
  return { maps = maps, things = things, groups = groups, solids = json_text.list(all.solids), radii = radii }
end

return shared
