-- Small dense matrices, as lists of columns: dot products, linear least squares by Householder's orthogonal decomposition,
-- singular values by one-sided rotations (Golub and Van Loan, Matrix computations, 5.2 and 8.6). For some ten columns.
local linear = {}

function linear.dot(a, b)
  local sum = 0
  for k = 1, #a do sum = sum + a[k] * b[k] end
  return sum
end

-- Reflects the vectors such that the first has nothing below row k; gives its entry there.
local function reflect(vectors, at, k)
  local a, norm = vectors[at], 0
  for i = k, #a do norm = norm + a[i] * a[i] end
  norm = math.sqrt(norm)
  if norm == 0 then return end
  local alpha = a[k] > 0 and -norm or norm
  local v, vv = {}, 0
  for i = k, #a do
    v[i] = a[i] - (i == k and alpha or 0)
    vv = vv + v[i] * v[i]
  end
  for j = at, #vectors do
    local b, s = vectors[j], 0
    for i = k, #b do s = s + v[i] * b[i] end
    s = 2 * s / vv
    for i = k, #b do b[i] = b[i] - s * v[i] end
  end
end

-- The upper triangle R of A = Q R, by columns of n numbers.
function linear.triangle(columns)
  local n, vectors = #columns, {}
  for j, column in ipairs(columns) do
    vectors[j] = table.move(column, 1, #column, 1, {})
    for i = #column + 1, n do vectors[j][i] = 0 end
  end
  for k = 1, n do reflect(vectors, k, k) end
  for j = 1, n do vectors[j] = table.move(vectors[j], 1, n, 1, {}) end
  return vectors
end

-- x for which |A x - b|^2 + |diagonal x|^2 is least; a column of zeros has x = 0.
function linear.least_squares(columns, b, diagonal)
  local n, m, vectors = #columns, #b, {}
  for j = 1, n do
    vectors[j] = table.move(columns[j], 1, m, 1, {})
    for i = 1, n do vectors[j][m + i] = i == j and diagonal[j] or 0 end
  end
  local right = table.move(b, 1, m, 1, {})
  for i = 1, n do right[m + i] = 0 end
  vectors[n + 1] = right
  for k = 1, n do reflect(vectors, k, k) end
  local x = {}
  for k = n, 1, -1 do
    local sum = right[k]
    for j = k + 1, n do sum = sum - vectors[j][k] * x[j] end
    x[k] = vectors[k][k] ~= 0 and sum / vectors[k][k] or 0
  end
  return x
end

-- Singular values and the right singular vectors of a matrix, the largest first: { { value, vector }, ... }.
function linear.singular(columns)
  local n, a, v = #columns, {}, {}
  for j = 1, n do
    a[j], v[j] = table.move(columns[j], 1, #columns[j], 1, {}), {}
    for i = 1, n do v[j][i] = i == j and 1 or 0 end
  end
  local function rotate(vectors, p, q, c, s)
    local x, y = vectors[p], vectors[q]
    for i = 1, #x do x[i], y[i] = c * x[i] - s * y[i], s * x[i] + c * y[i] end
  end
  for _ = 1, 60 do
    local most = 0
    for p = 1, n - 1 do
      for q = p + 1, n do
        local alpha, beta, gamma = linear.dot(a[p], a[p]), linear.dot(a[q], a[q]), linear.dot(a[p], a[q])
        local cosine = alpha * beta > 0 and math.abs(gamma) / math.sqrt(alpha * beta) or 0
        most = math.max(most, cosine)
        if cosine > 1e-16 then
          local zeta = (beta - alpha) / (2 * gamma)
          local t = (zeta >= 0 and 1 or -1) / (math.abs(zeta) + math.sqrt(1 + zeta * zeta))
          local c = 1 / math.sqrt(1 + t * t)
          rotate(a, p, q, c, c * t)
          rotate(v, p, q, c, c * t)
        end
      end
    end
    if most < 1e-15 then break end
  end
  local list = {}
  for j = 1, n do list[j] = { value = math.sqrt(linear.dot(a[j], a[j])), vector = v[j] } end
  table.sort(list, function(x, y) return x.value > y.value end)
  return list
end

-- Directions in which a matrix does next to nothing: the right singular vectors, of length 1, whose values are at most
-- `part` of the largest. The second result: all of them, as linear.singular gives them.
function linear.blind(columns, part)
  local all, list = linear.singular(linear.triangle(columns)), {}
  for _, one in ipairs(all) do
    if one.value <= part * all[1].value then list[#list + 1] = one.vector end
  end
  return list, all
end

return linear
