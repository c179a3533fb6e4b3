-- First guesses of controls: the scene's own, and smooth random ones whose size is that of an optimum.
local starts = {}

-- A stream of numbers in [-1, 1) (Lehmer's generator with Park's and Miller's factor).
local function stream(seed)
  local x = (seed * 2654435761 + 1) % 2147483647
  return function()
    x = x * 48271 % 2147483647
    return 2 * x / 2147483647 - 1
  end
end

-- The values of all controls of guess k, one after the other: waves of the first orders, of some `size`.
function starts.random(controls, k, size)
  local draw, values = stream(7919 * k + 17), {}
  for _ = 1, 8 do draw() end
  local largest = size * (0.5 + 1.5 * math.abs(draw()))
  for _, control in ipairs(controls) do
    local part = {}
    for order = 1, 4 do part[order] = draw() / order end
    for j = 1, #control.values do
      local at, sum = (j - 1) / (#control.values - 1), 0
      for order = 1, 4 do sum = sum + part[order] * math.cos((order - 1) * math.pi * at) end
      values[#values + 1] = largest * sum
    end
  end
  return values
end

return starts
