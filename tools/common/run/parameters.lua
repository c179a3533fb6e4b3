-- Parameters of a scene that a tool finds or changes, as they are named on its command line with --by: k,c or
-- k=START:LOW:HIGH, completed by what the script's param() says.
local parameters = {}

-- "name=start:low:high", of which what follows the name may be left out.
function parameters.wanted(words, option)
  local list = {}
  option = option or "--by"
  for _, word in ipairs(words) do
    for piece in (word .. ","):gmatch("([^,]*),") do
      local name, rest = piece:match("^%s*([%a_][%w_]*)%s*(.*)$")
      if not name then return nil, ("%s: '%s' is not a name, or name=start:low:high"):format(option, piece) end
      local numbers = {}
      for text in rest:gmatch("[^=:]+") do
        numbers[#numbers + 1] = tonumber(text)
        if not numbers[#numbers] then return nil, ("%s: %s: '%s' is not a number"):format(option, name, text) end
      end
      if #numbers > 3 then return nil, ("%s: %s: one start and two bounds, name=start:low:high"):format(option, name) end
      list[#list + 1] = { name = name, start = numbers[1], low = numbers[2], high = numbers[3] }
    end
  end
  if #list == 0 then return nil, "nothing to find: --by NAME,NAME" end
  return list
end

local function complete(p, declared)
  local function bound(given, own, none) return given or (own and own == own and own) or none end
  p.help = declared.help
  p.start = p.start or tonumber(declared.initial)
  p.low, p.high = bound(p.low, declared.min, -math.huge), bound(p.high, declared.max, math.huge)
  if not p.start or declared.type ~= "number" and declared.type ~= "integer" then
    return nil, ("--by: %s is no number, but a %s; name a parameter that is one"):format(p.name, declared.type)
  end
  if p.low >= p.high then return nil, ("--by: %s: %g is not below %g"):format(p.name, p.low, p.high) end
  if p.start < p.low or p.start > p.high then
    return nil, ("--by: %s: the start, %g, is not within %g to %g"):format(p.name, p.start, p.low, p.high)
  end
  return true
end

-- Fills in what the script's param() says. list: of `wanted`; given: other parameters by name; or nil and what is wrong.
function parameters.complete(list, explained, given)
  local by_name, names, seen = {}, {}, {}
  for k, p in ipairs(explained.parameters) do by_name[p.name], names[k] = p, p.name end
  for _, p in ipairs(list) do
    local declared = by_name[p.name]
    if not declared then
      local near = hooke.nearest(p.name, names)
      return nil, ("the scene has no parameter '%s'; %s"):format(p.name, near and ("did you mean '%s'?"):format(near)
        or #names > 0 and "it has " .. table.concat(names, ", ") or "it has none: param(name, default)")
    end
    if seen[p.name] then return nil, ("--by: %s is there twice"):format(p.name) end
    if given[p.name] then return nil, ("%s=%s and --by %s: leave one out"):format(p.name, given[p.name], p.name) end
    seen[p.name] = true
    local fine, why = p.values ~= nil, nil -- a control
    if not fine then fine, why = complete(p, declared) end
    if not fine then return nil, why end
  end
  return true
end

-- What counts as a small change of a parameter: a thousandth of its value, of its bounds where that is 0, or of 1.
function parameters.scale(p)
  local width = p.high - p.low
  return p.start ~= 0 and math.abs(p.start) * 1e-3 or width < math.huge and width * 1e-3 or 1e-3
end

return parameters
