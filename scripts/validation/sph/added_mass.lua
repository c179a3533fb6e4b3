-- A disc begins to sink in the middle of a round can that is full of a liquid whose pressure acts on it (`incompressible`): its
-- weight has to set the liquid in motion that it drives round itself. Disc, can and liquid lie on one lattice.
local sph, validation = require("_sph"), require("validation")

local g, radius, can, ratio, finish = 10, 0.25, 0.5, 2, 0.1 -- m/s^2, m, m, densities of disc and liquid, s

-- A cylinder of the radius a in one of the radius b drives the mass (b^2 + a^2)/(b^2 - a^2) of the liquid that it displaces.
local driven = (can ^ 2 + radius ^ 2) / (can ^ 2 - radius ^ 2)

return validation.problem {
  title = "A disc begins to sink",
  quantities = {
    { name = "acceleration", unit = "m/s^2", reference = g * (ratio - 1) / (ratio + driven),
      source = "Lamb 1932, Hydrodynamics, chapter 4: added mass of a cylinder in another; without it 5 m/s^2", noise = 5e-2 },
  },
  space = { 24, 32, 48 },
  space_label = "1/n, particles on the can's diameter",
  tolerance = 0.12,
  why = "round walls are steps of the lattice, and a liquid on its lattice gives way at first",
  quick = { space = { 16, 24, 32 }, tolerance = 0.15 },
  solve = function(at)
    local dx = 2 * can / at.n
    local scene = hooke.scene { duration = finish, fps = 1 / finish, dt = finish / math.ceil(finish / (0.04 * dx)),
      integrator = "symplectic_euler" }
    local low, high = { -can - 4 * dx, -can - 4 * dx }, { can + 4 * dx, can + 4 * dx }
    local function water(x, z) return x ^ 2 + z ^ 2 > radius ^ 2 and x ^ 2 + z ^ 2 < can ^ 2 end
    sph.fill(scene, dx, low, high, { inside = water })
    sph.fill(scene, dx, low, high, { walls = true, inside = function(x, z) return x ^ 2 + z ^ 2 >= can ^ 2 end })
    local points = {}
    for i = -at.n // 2, at.n // 2 do
      for j = -at.n // 2, at.n // 2 do
        local x, z = (i + 0.5) * dx, (j + 0.5) * dx
        if x ^ 2 + z ^ 2 <= radius ^ 2 then points[#points + 1] = { x, 0, z } end
      end
    end
    local disc = scene:rigid { shape = "box", size = { radius, dx, radius }, -- of the mass that the points stand for
      density = ratio * sph.density * #points * (dx / radius) ^ 2 }
    disc:surface(points)
    scene:joint { kind = "slider", a = disc, at = { 0, 0, 0 }, axis = { 0, 0, 1 } } -- it stays in the plane
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:corrector("incompressible", { spacing = dx, dimensions = 2, reach = sph.reach, density = sph.density, wall_volume = dx ^ 3,
      tolerance = 1e-5, divergence = 1e-5, iterations = 2000 })
    return -disc:velocity(scene:run { to = finish }:state())[3] / finish
  end,
}
