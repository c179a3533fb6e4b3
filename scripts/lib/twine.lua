-- twine: a net of knotted twine, for scenes that catch something in it.
local twine = {}
local per = 3 -- edges per mesh

-- A square net of t.meshes meshes along each side (t.side, m), flat at t.height and pinned by its rim: warp and weft that
-- cross at 2.2 radii (t.radius, m) from each other, tied there. Springs of t.k N/m hold both.
function twine.net(scene, t)
  local n, side = t.meshes, t.side
  local function thread(k, along)
    local at = side * (k / n - 0.5)
    local function point(s, z) return along and { s, at, z } or { at, s, z } end
    local z = along and t.height or t.height + 2.2 * t.radius
    return scene:strand { n = per * n + 1, mass = t.mass, group = along and "weft" or "warp",
      from = point(-side / 2, z), to = point(side / 2, z) }
  end
  local warp, weft, edges, knots, rim = {}, {}, nil, {}, {}
  for k = 0, n do
    weft[k], warp[k] = thread(k, true), thread(k, false)
    for _, one in ipairs { weft[k], warp[k] } do
      edges = edges and edges .. one:edges() or one:edges()
      rim[#rim + 1], rim[#rim + 2] = one:at(1), one:at(per * n + 1)
    end
  end
  for i = 0, n do
    for j = 0, n do knots[#knots + 1] = { weft[j]:at(per * i + 1), warp[i]:at(per * j + 1) } end
  end
  scene:pin(rim)
  scene:force("springs", { edges = edges, k = t.k, damping = 0.1, label = "twine" })
  scene:force("springs", { edges = knots, k = t.k, damping = 0.1, label = "knots" })
end

return twine
