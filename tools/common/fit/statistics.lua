-- What a fit knows of its parameters: standard deviations and correlations from the Jacobian of the weighted residuals, and
-- the combinations that the data do not determine.
local linear = require("common.fit.linear")

local statistics = {}

-- J by columns; sizes: of the parameters, by which changes are relative. Returns the inverse of J^T J as a matrix of rows,
-- without the directions that are not determined, and these: { { { j, part }, ... }, ... } with the relative changes that
-- together change nothing.
function statistics.inverse(J, sizes)
  local n, inverse, named = #J, {}, {}
  local blind, parts = linear.blind(statistics.scaled(J, sizes), statistics.blind)
  for j = 1, n do
    inverse[j] = {}
    for i = 1, n do
      inverse[j][i] = 0
      for k = 1, n - #blind do
        local v = parts[k].vector
        inverse[j][i] = inverse[j][i] + v[j] * v[i] / parts[k].value ^ 2 * sizes[j] * sizes[i]
      end
    end
  end
  for k, vector in ipairs(blind) do
    named[k] = {}
    for j = 1, n do
      if math.abs(vector[j]) > 0.1 then table.insert(named[k], { j, vector[j] }) end
    end
  end
  return inverse, named
end

function statistics.scaled(J, sizes)
  local scaled = {}
  for j = 1, #J do
    scaled[j] = {}
    for k, x in ipairs(J[j]) do scaled[j][k] = x * sizes[j] end
  end
  return scaled
end

-- Below such a part of the largest singular value, relative changes of the parameters are lost in the differences by which
-- the Jacobian is found.
statistics.blind = 1e-7

-- sd of each parameter and the matrix of correlations; `variance` of a weighted residual. NAN: not determined.
function statistics.deviations(inverse, blind, variance)
  local sd, correlation = {}, {}
  for j = 1, #inverse do sd[j] = math.sqrt(variance * inverse[j][j]) end
  for _, direction in ipairs(blind) do
    for _, item in ipairs(direction) do sd[item[1]] = 0 / 0 end
  end
  for j = 1, #inverse do
    correlation[j] = {}
    for i = 1, #inverse do
      correlation[j][i] = i == j and 1 or variance * inverse[j][i] / (sd[j] * sd[i])
    end
  end
  return sd, correlation
end

-- How the optimum moves where the residuals change by dr: -(J^T J)^-1 J^T dr.
function statistics.shift(J, inverse, dr)
  local slope, x = {}, {}
  for j = 1, #J do slope[j] = linear.dot(J[j], dr) end
  for j = 1, #J do x[j] = -linear.dot(inverse[j], slope) end
  return x
end

-- Of numbers in the order of time, each with the next one of its kind: 0 for chance, 1 for a smooth curve.
function statistics.serial_correlation(r, kinds)
  local last, sum, squares = {}, 0, 0
  for k = 1, #r do
    if last[kinds[k]] then sum = sum + last[kinds[k]] * r[k] end
    last[kinds[k]] = r[k]
    squares = squares + r[k] * r[k]
  end
  return squares > 0 and sum / squares or 0
end

return statistics
