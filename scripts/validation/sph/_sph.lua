-- Liquids by particles in the plane y = 0: lattices, walls of three layers, densities. Imported by problems of this folder.
local sph = { reach = 3, density = 1000 }

-- A lattice of spacing dx in x and z between low and high = { x, z }, where inside(x, z) is true, pinned to the plane.
-- velocity(x, z) is that of a particle. Returns ids.
function sph.fill(scene, dx, low, high, options)
  options = options or {}
  local ids = {}
  for j = 1, math.floor((high[2] - low[2]) / dx + 0.5) do
    for i = 1, math.floor((high[1] - low[1]) / dx + 0.5) do
      local x, z = low[1] + (i - 0.5) * dx, low[2] + (j - 0.5) * dx
      if not options.inside or options.inside(x, z) then
        local u, w = 0, 0
        if options.velocity then u, w = options.velocity(x, z) end
        ids[#ids + 1] = scene:particle { position = { x, 0, z }, velocity = { u, 0, w }, mass = sph.density * dx ^ 3 }
      end
    end
  end
  if options.walls then
    scene:pin(ids)
  else
    scene:pin(ids, { normal = { 0, 1, 0 } })
  end
  return ids
end

-- The forces; options: c (m/s; left out: incompressible), mu (Pa s), slip, reach, cavitates.
function sph.forces(scene, dx, options)
  local function common(t)
    t.spacing, t.dimensions, t.density = dx, 2, sph.density
    t.reach, t.wall_volume = options.reach or sph.reach, dx ^ 3
    return t
  end
  if options.c then
    scene:force("sph", common { c = options.c, cavitates = options.cavitates ~= false })
  else
    scene:corrector("incompressible", common {})
  end
  if options.mu then scene:force("viscosity", common { mu = options.mu, slip = options.slip }) end
end

-- Taylor and Green's vortices of the amplitude U, m/s, in a periodic box of the side `length`, m, with n x n particles and the
-- viscosity nu, m^2/s; c: speed of sound, m/s, nil: incompressible. Returns a function: their amplitude at a time, m/s.
function sph.vortices(scene, n, length, U, nu, c)
  local k, dx = 2 * math.pi / length, length / n
  local function mode(x, z) return math.sin(k * x) * math.cos(k * z), -math.cos(k * x) * math.sin(k * z) end
  local ids = sph.fill(scene, dx, { 0, 0 }, { length, length },
    { velocity = function(x, z) local u, w = mode(x, z) return U * u, U * w end })
  scene:periodic { high = { length, length, length }, axes = "xz" }
  sph.forces(scene, dx, { c = c, mu = sph.density * nu, cavitates = false })
  return function(t)
    local state, sum, norm = scene:run { to = t }:state(), 0, 0
    for _, id in ipairs(ids) do
      local x, v = state:position(id), state:velocity(id)
      local u, w = mode(x[1], x[3])
      sum, norm = sum + u * v[1] + w * v[3], norm + u * u + w * w
    end
    return sum / norm
  end
end

local function shape(t) return t < 1 and (1 - t) ^ 4 * (1 + 4 * t) or 0 end

-- kg/m^3: the density of particle `id` by those of `all`, in a box that repeats along x with that length, or none.
function sph.density_at(state, id, all, dx, length)
  local R, sum, lattice = sph.reach * dx, 0, 0
  for i = -3, 3 do
    for j = -3, 3 do lattice = lattice + shape(math.sqrt(i * i + j * j) / sph.reach) end
  end
  local p = state:position(id)
  for _, other in ipairs(all) do
    local q = state:position(other)
    local x = p[1] - q[1]
    if length then x = x - length * math.floor(x / length + 0.5) end
    sum = sum + shape(math.sqrt(x * x + (p[3] - q[3]) ^ 2) / R)
  end
  return sph.density * sum / lattice
end

return sph
