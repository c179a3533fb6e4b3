-- A chain of nine particles held at one end that swings in its slowest normal mode: far_away, huge_units, tiny_units.
-- c: spacing (m), mass (kg), k (N/m), amplitude (m), origin, and what hooke.scene takes.
return function(c)
  local n, a, m, k, A, o = 8, c.spacing, c.mass, c.k, c.amplitude, c.origin or { 0, 0, 0 }
  local theta = math.pi / (2 * n + 1)
  local w = 2 * math.sqrt(k / m) * math.sin(theta / 2)
  local scene = hooke.scene(c.scene)

  local function at(i, t) return { o[1] + i * a + A * math.sin(i * theta) * math.cos(w * t), o[2], o[3] } end
  local edges = {}
  for i = 0, n do
    scene:particle { position = at(i, 0), mass = m }
    if i > 0 then edges[i] = { i, i + 1 } end
  end
  scene:pin { 1 }
  scene:force("springs", { edges = edges, k = k, rest = a })

  scene:exact(function(t)
    local x = {}
    for i = 0, n do x[i + 1] = at(i, t) end
    return x
  end)
  return scene
end
