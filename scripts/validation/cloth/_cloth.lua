-- What the problems about cloth share.
local validation = require("validation")

local cloth = {}

-- The energy per area, J/m^2, of edges that are at rest in the plane and are strained by (xx, yy, xy): the mean of the
-- strain and its opposite, which leaves no term of third order. place(k): where particle k rests.
function cloth.strain_energy(count, place, springs, area, xx, yy, xy)
  local sum = 0
  for sign = -1, 1, 2 do
    local scene = hooke.scene { duration = 0 }
    for k = 1, count do
      local x, y = place(k)
      scene:particle { position = { x + sign * (xx * x + xy * y), y + sign * (yy * y + xy * x), 0 } }
    end
    local rest = {}
    for e = 1, #springs.edges do
      local x, y = place(springs.edges[e][1])
      local X, Y = place(springs.edges[e][2])
      rest[e] = math.sqrt((X - x) ^ 2 + (Y - y) ^ 2)
    end
    scene:force("springs", { edges = springs.edges, k = springs.k, rest = rest })
    sum = sum + scene:run { to = 0 }:state():potential() / 2
  end
  return sum / area
end

-- Young's modulus and Poisson's ratio of a sheet from three strains of size e; W(xx, yy, xy) is its energy per area.
function cloth.elasticity(W, e)
  local C11, C22 = 2 * W(e, 0, 0) / e ^ 2, 2 * W(0, e, 0) / e ^ 2
  local C12 = (2 * W(e, e, 0) / e ^ 2 - C11 - C22) / 2
  local C66 = W(0, 0, e) / (2 * e ^ 2)
  return { C11 = C11, C22 = C22, C12 = C12, C66 = C66, E = C11 - C12 ^ 2 / C22, nu = C12 / C22 }
end

-- The squares of a sheet of side 1 m with cells 1/n: springs { edges =, k = } of numbers of the material, and masses of
-- a density. Ids run along x, then along y, as in a scene whose first particles are those of cloth.add.
function cloth.squares(n, density, numbers)
  local scene, masses = hooke.scene {}, {}
  local grid = scene:grid { nx = n + 1, ny = n + 1 }
  local function share(i) return (i == 0 or i == n) and 0.5 or 1 end
  for j = 0, n do
    for i = 0, n do masses[#masses + 1] = density / n ^ 2 * share(i) * share(j) end
  end
  return numbers and scene:membrane(grid, numbers), masses
end

-- Adds those particles at z(x, y) with the velocity speed(x, y) along z; returns the ids of the border, and of all, and
-- the weights with which the mean of z over the area is taken, times the mode sin(pi x) sin(pi y).
function cloth.add(scene, n, masses, z, speed)
  local positions, velocities, border, mode = {}, {}, {}, {}
  for k = 1, (n + 1) ^ 2 do
    local i, j = (k - 1) % (n + 1), (k - 1) // (n + 1)
    local x, y = i / n, j / n
    positions[k], velocities[k] = { x, y, z(x, y) }, { 0, 0, speed(x, y) }
    if i == 0 or j == 0 or i == n or j == n then border[#border + 1] = k end
    mode[k] = math.sin(math.pi * x) * math.sin(math.pi * y)
  end
  scene:particles { positions = positions, velocities = velocities, masses = masses }
  return border, mode
end

-- The period of the part of the motion along z that is in the mode, in steps of h.
function cloth.period(scene, mode, h, steps)
  local rises = validation.crossings(1)
  validation.each(scene, h, steps, function(s, t)
    local z, v = 0, 0
    for k, w in ipairs(mode) do
      if w > 1e-9 then z, v = z + w * s:position(k)[3], v + w * s:velocity(k)[3] end
    end
    if t > 0 then rises(t, z, v) end
  end)
  local times = rises.times
  return (times[#times] - times[1]) / (#times - 1)
end

return cloth
