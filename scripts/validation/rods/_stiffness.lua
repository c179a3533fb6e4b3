-- The stiffness of a straight rod across its axis, x, measured node by node: node j is moved by a little in one step
-- without force, and the forces that answer are read. The first edge, and with `both` the last, lie in walls.
local stiffness = {}

-- n free edges of length 1/n; params: of the rods, with its edges left out; size: m, of the moves (1e-5 of an edge).
-- Returns { [j] = { [i] = -dF_i/dy_j } }, each a vector of y and z, for the free nodes 1, 2, ...
function stiffness.across(n, both, params, size)
  local last = both and n - 1 or n
  size = size or 1e-5 / n
  local function column(j)
    local scene = hooke.scene { duration = 1, fps = 1, dt = 1, integrator = "leapfrog" }
    local positions, velocities, edges = {}, {}, {}
    for i = -1, both and n + 1 or n do
      positions[i + 2], velocities[i + 2] = { i / n, 0, 0 }, { 0, i == j and size or 0, 0 }
      if i >= 0 then edges[i + 1] = { i + 1, i + 2 } end
    end
    scene:particles { positions = positions, velocities = velocities, mass = 1e30 } -- too heavy to be pushed back
    scene:pin(both and { 1, 2, n + 2, n + 3 } or { 1, 2 })
    params.edges = edges
    scene:force("rods", params)
    local s, found = scene:run():state(), {}
    for i = 1, last do
      local F = s:force("rods", i + 2)
      found[i] = { -F[2] / size, -F[3] / size }
    end
    return found
  end
  local K = {}
  for j = 1, last do K[j] = column(j) end
  return K
end

-- Whether a symmetric matrix, by function at(row, column) for row >= column, is positive definite; `band`: entries
-- farther from the diagonal are zero.
function stiffness.definite(at, size, band)
  local L = {}
  for r = 1, size do
    L[r] = {}
    for c = math.max(1, r - band), r do
      local sum = at(r, c)
      for k = math.max(1, r - band), c - 1 do sum = sum - L[r][k] * (L[c][k] or 0) end
      if r == c then
        if sum <= 0 then return false end
        L[r][r] = math.sqrt(sum)
      else L[r][c] = sum / L[c][c] end
    end
  end
  return true
end

-- The greatest x in (low, high) up to which definite(x) holds.
function stiffness.limit(definite, low, high)
  while high - low > 1e-12 * high do
    local middle = (low + high) / 2
    if definite(middle) then low = middle else high = middle end
  end
  return low
end

return stiffness
