-- The functions that hooke check gives to parameters that are functions of the script.
local functions = {}

-- Smooth functions of all that they are given but the id, which births and deaths change; what has one result is taken
-- to be an energy or an equation, and depends on the time only where `moving` says so.
function functions.made(p, factor, moving)
  if p.text:find("^function%(t%)") then -- of time alone: a positive number
    return function(t) return factor * (20 + 10 * math.sin(3 * t)) end
  end
  local _, arguments = p.text:match("%((.*), id%)"):gsub("[%w_]+", "")
  local _, results = p.text:match("%->(.*)"):gsub("[%w_]+", "")
  return function(...)
    local given, out = { ... }, {}
    if results == 1 then
      local still = factor * (math.sin(given[2]) * math.cos(0.7 * given[3]) + given[4] ^ 2 * given[2])
      return moving and still + 0.3 * factor * math.sin(given[1] + 0.5 * given[4]) or still
    end
    for r = 1, results do
      out[r] = 0
      for k = 1, arguments do out[r] = out[r] + factor * math.sin(0.3 * r * given[k] + 0.1 * k) / k end
    end
    return table.unpack(out)
  end
end

return functions
