-- A block of half the liquid's density in a tank: it floats half immersed. The block is a rigid body whose points lie like
-- the liquid's particles; depth and tank are measured as the particles fill them, so that the answer is that of volumes. By
-- compression (`sph`) and by pressures (`incompressible`).
local sph, validation = require("_sph"), require("validation")

local g, c, depth, width, side, ratio = 10, 30, 0.5, 1, 0.5, 0.5 -- m/s^2, m/s, m, m, m

local function immersed(at, by)
  local dx = width / at.n
  local h, seconds = by == "sph" and 0.6 * dx / c or 0.08 * dx, at.quick and 0.5 or 2
  local scene = hooke.scene { duration = seconds, fps = 1, dt = h,
    integrator = by == "sph" and "leapfrog" or "symplectic_euler" }
  local low, bottom = (width - side) / 2, depth - side * ratio
  local water = sph.fill(scene, dx, { 0, 0 }, { width, depth },
    { inside = function(x, z) return z < bottom or x < low or x > low + side end })
  sph.fill(scene, dx, { 0, -3 * dx }, { width, 0 }, { walls = true })
  local block = scene:rigid { shape = "box", size = { side, dx, side }, density = ratio * sph.density,
    position = { width / 2, 0, bottom + side / 2 } }
  local points, count = {}, math.floor(side / dx + 0.5)
  for i = 1, count do
    for j = 1, count do points[#points + 1] = { (i - 0.5) * dx - side / 2, 0, (j - 0.5) * dx - side / 2 } end
  end
  block:surface(points)
  scene:joint { kind = "slider", a = block, at = { width / 2, 0, bottom }, axis = { 0, 0, 1 } } -- it stays in the plane
  scene:periodic { high = { width, 1, 1 }, axes = "x" }
  scene:force("gravity", { g = { 0, 0, -g } })
  sph.forces(scene, dx, { c = by == "sph" and c or nil, mu = (by == "sph" and 0.2 or 0.02) * sph.density * c * dx })
  local state = scene:run { to = seconds }:state()
  local under = block:position(state)[3] - side / 2
  local level = (#water * dx ^ 2 - side * under) / (width - side) -- of the volume width x level - side x (level - under)
  return (level - under) / side
end

return validation.problem {
  title = "Depth of a floating block",
  quantities = {
    { name = "immersed", unit = "", reference = ratio, source = "Archimedes, the ratio of the densities",
      noise = 5e-3 },
    { name = "immersed_incompressible", unit = "", reference = ratio, source = "the same", noise = 5e-3 },
  },
  space = { 16, 24, 32 },
  space_label = "1/n, particles on the tank's width",
  tolerance = 3e-2,
  why = "the level is that of the particles' volumes, which leaves out how the surface is pulled in",
  quick = { space = { 8, 12, 16 }, tolerance = 0.1 },
  solve = function(at) return { immersed = immersed(at, "sph"), immersed_incompressible = immersed(at, "incompressible") } end,
}
