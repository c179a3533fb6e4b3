-- Square sheets of springs and hinges, for the problems about sheets in contact.
local sheets = {}

-- Adds a sheet of nx by nx particles of the side `size`, m, and the density, kg/m^2, at `origin`, its rows along u (and
-- y), damped within `damping` seconds; returns its ids.
function sheets.add(scene, t)
  local grid = scene:grid { nx = t.nx, ny = t.nx, width = t.size, height = t.size, density = t.density, alternating = true,
    origin = t.origin, u = t.u, v = t.u and { 0, 1, 0 } }
  local ids, springs = grid:ids(), scene:membrane(grid, { stiffness = 10, nu = 1 / 3, damping = t.damping })
  springs.label = ("springs of %d"):format(ids[1])
  scene:force("springs", springs)
  scene:force("hinges", { triangles = grid:triangles(), rigidity = 1e-5, damping = t.damping and 1e-7,
    label = ("hinges of %d"):format(ids[1]) })
  return ids
end

-- An even acceleration of some particles until a time: how a sheet gets its speed.
function sheets.push(scene, ids, acceleration, to)
  scene:force("gravity", { g = acceleration, only = ids, to = to, label = ("push of %d"):format(ids[1]) })
end

-- The mean over the particles of the place and of the speed along a direction.
function sheets.mean(state, ids, along)
  local x, speed = 0, 0
  for _, id in ipairs(ids) do
    local p, w = state:position(id), state:velocity(id)
    for c = 1, 3 do x, speed = x + p[c] * along[c] / #ids, speed + w[c] * along[c] / #ids end
  end
  return x, speed
end

return sheets
