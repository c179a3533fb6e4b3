-- Units of what diagrams, tables and pages show: a measure's is what its scene says (scene:measure's `unit`), that of a
-- parameter or control stands at the end or the beginning of its help, as in "stiffness, N/m" and "rad/s, about the stem".
local units = {}

local symbols = {}
for word in ("m mm cm km kg s ms N kN mN J kJ mJ W kW Pa kPa MPa GPa K rad deg degrees Hz V C mol °C °"):gmatch("%S+") do
  symbols[word] = true
end

-- Whether a text is made of symbols of units, powers of them and signs between: "N s/m", "kg m^2/s", "1/s".
local function is_unit(text)
  local words, plain = 0, text:gsub("²", "^2"):gsub("³", "^3")
  for word in plain:gsub("/", " "):gsub("[()]", ""):gmatch("%S+") do
    local symbol = word:match("^(.-)%^%-?%d+$") or word
    words = words + 1
    if not symbols[symbol] and not (words == 1 and symbol == "1" and plain:find("^1/")) then return false end
  end
  return words > 0
end

-- The unit that a help says; nil: it says none.
function units.of_help(help)
  if not help then return nil end
  for _, text in ipairs { help:match("([^,]*)$"), help:match("^([^,]*)") } do
    local plain = text:match("^%s*(.-)%s*$")
    if is_unit(plain) then return plain end
  end
end

-- { name = unit } of parameters that a scene declares.
function units.of_parameters(parameters)
  local list = {}
  for _, p in ipairs(parameters or {}) do list[p.name] = units.of_help(p.help) end
  return list
end

-- A name with its unit, for an axis; and for the head of a column.
function units.label(name, unit) return unit and unit ~= "" and name .. ", " .. unit or name end
function units.heading(name, unit) return unit and unit ~= "" and ("%s [%s]"):format(name, unit) or name end

-- The name and the unit of a column's head; no unit: nil.
function units.of_heading(text)
  local name, unit = text:match("^(.-)%s*%[([^%[%]]*)%]$")
  if name then return name, unit end
  return text
end

-- "m/(N/m)", the unit of a derivative; where one of both is not said, nil.
function units.quotient(of, by)
  if not of or not by or of == "" or by == "" then return nil end
  return ("%s/%s"):format(of, by:find("[/ ]") and "(" .. by .. ")" or by)
end

return units
