-- States on constraints and the directions along these: with the derivative D of putting a state onto them (record:place), which projects
-- along the constraints there. What a segment misses of the state behind it counts along them alone, since both are on them, and so do its
-- derivatives and its multipliers: Newton's method on the manifold (Absil, Mahony and Sepulchre, Optimization algorithms on matrix
-- manifolds, 2008, 4.1 and 6.2). D: columns, one behind the other.
local tangents = {}

-- D x
function tangents.along(D, x)
  local n, y = #x, {}
  for i = 1, n do y[i] = 0 end
  for c = 1, n do
    if x[c] ~= 0 then
      local at = (c - 1) * n
      for i = 1, n do y[i] = y[i] + D[at + i] * x[c] end
    end
  end
  return y
end

-- D^T x
function tangents.back(D, x)
  local n, y = #x, {}
  for c = 1, n do
    local sum, at = 0, (c - 1) * n
    for i = 1, n do sum = sum + D[at + i] * x[i] end
    y[c] = sum
  end
  return y
end

-- The columns of J, each along D.
function tangents.columns(D, J, n)
  local list = {}
  for c = 0, #J // n - 1 do table.move(tangents.along(D, table.move(J, c * n + 1, c * n + n, 1, {})), 1, n, c * n + 1, list) end
  return list
end

-- The multipliers of all segments, each along the constraints at its end; D of every knot.
function tangents.multipliers(D, list)
  local along = {}
  for k, multiplier in ipairs(list) do along[k] = tangents.back(D[k + 1], multiplier) end
  return along
end

return tangents
