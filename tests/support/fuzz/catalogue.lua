-- The plugins that hooke offers, with their parameters, read from its own catalogue: hooke plugins, hooke plugins NAME.
local catalogue = {}

local types = { "number", "integer", "boolean", "string", "choice", "vector", "numbers", "particles", "edges", "triangles",
  "tetrahedra", "per tuple" }

local function said(command)
  local pipe = assert(io.popen(command .. " 2>&1"))
  local text = pipe:read("a")
  assert(pipe:close(), text)
  return text
end

-- "  k   N/m   per tuple default required   stiffness" -> { name = "k", type = "per tuple" }
local function parameter_of(line)
  local name, rest = line:match("^  ([%w_]+) +(.*)$")
  local before = rest and rest:match("^(.-) +default ")
  for _, kind in ipairs(before and types or {}) do
    if before == kind or before:sub(-#kind - 1) == " " .. kind then
      return { name = name, type = kind, required = rest:find(" default required ", 1, true) ~= nil }
    end
  end
end

-- The line below a parameter: its range or its choices.
local function limit(parameter, line)
  local low, high = line:match("^ +(%S+) to (%S+)")
  parameter.min, parameter.max = tonumber(low or line:match("^ +>= (%S+)")), tonumber(high)
  parameter.timed = line:find("function of t", 1, true) ~= nil
  if parameter.type == "choice" then parameter.choices = line:match("^ +(%S+)") end
end

local function parameters_of(text)
  local list, last = {}, nil
  for line in text:gmatch("[^\n]+") do
    local parameter = parameter_of(line)
    if parameter then list[#list + 1] = parameter
    elseif last and line:find("^              ") then limit(last, line) end
    last = parameter
  end
  return list
end

-- { force = { { name =, params = { { name =, type =, min =, max =, timed =, choices = }, ... } }, ... }, integrator = ... }
function catalogue.read(hooke)
  local kinds, kind = {}, nil
  for line in said(hooke .. " plugins"):gmatch("[^\n]+") do
    kind = line:match("^(%l+)$") or kind
    local name = line:match("^  ([%w_]+) ")
    if line:match("^%l+$") then kinds[kind] = {} end
    if name then table.insert(kinds[kind], { name = name, params = parameters_of(said(hooke .. " plugins " .. name)) }) end
  end
  return kinds
end

return catalogue
