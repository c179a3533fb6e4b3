-- A column of liquid at rest under gravity, on a floor of three layers, in a box that repeats along x. The pressure, by the
-- density of the particles, falls by density x g along it, and everything weighs on the floor.
local sph, validation = require("_sph"), require("validation")

local height, g, c = 1, 10, 40 -- m, m/s^2, m/s: 12 sqrt(g height)

-- The slope of a straight line through points, by least squares.
local function slope_of(xs, ys)
  local n, mx, my, xy, xx = #xs, 0, 0, 0, 0
  for k = 1, n do mx, my = mx + xs[k] / n, my + ys[k] / n end
  for k = 1, n do xy, xx = xy + (xs[k] - mx) * (ys[k] - my), xx + (xs[k] - mx) ^ 2 end
  return xy / xx
end

return validation.problem {
  title = "Pressure in a column of liquid",
  quantities = {
    { name = "slope", unit = "Pa/m", reference = -sph.density * g, source = "hydrostatics, -density g" },
    { name = "weight", unit = "N", reference = 1, source = "the whole weight on the floor, by itself", tolerance = 4e-3,
      noise = 4e-3, why = "the motion that is left" },
  },
  space = { 12, 16, 24, 32 },
  tolerance = 1e-2,
  why = "compressed by 0.3 % on the mean; pressure stops at 0 within the outermost layer, which is left out",
  quick = { space = { 8, 10, 12 }, tolerance = 0.1 },
  solve = function(at)
    local dx, wide, seconds = height / at.n, 8, at.quick and 1 or 3
    local h = 0.1 * dx * 3 / c
    local scene = hooke.scene { duration = seconds, fps = 1, dt = h, integrator = "leapfrog" }
    local water = sph.fill(scene, dx, { 0, 0 }, { wide * dx, height })
    local floor = sph.fill(scene, dx, { 0, -3 * dx }, { wide * dx, 0 }, { walls = true })
    scene:periodic { high = { wide * dx, 1, 1 }, axes = "x" }
    scene:force("gravity", { g = { 0, 0, -g } })
    sph.forces(scene, dx, { c = c, mu = 0.4 * sph.density * c * dx })
    local state = scene:run { to = seconds }:state()
    local all, z, p, load = {}, {}, {}, 0
    for _, list in ipairs { water, floor } do table.move(list, 1, #list, #all + 1, all) end
    for j = 1, at.n - 4, 2 do -- means of two layers, between which the pressure goes up and down by some percent
      local height_sum, pressure_sum = 0, 0
      for row = j, j + 1 do
        local id = water[(row - 1) * wide + 4]
        local s = sph.density_at(state, id, all, dx, wide * dx) / sph.density
        height_sum = height_sum + state:position(id)[3]
        pressure_sum = pressure_sum + sph.density * c ^ 2 * s ^ 2 * (s - 1)
      end
      z[#z + 1], p[#p + 1] = height_sum / 2, pressure_sum / 2
    end
    for _, id in ipairs(floor) do load = load - state:force("sph", id)[3] end
    return { slope_of(z, p), load / (#water * sph.density * dx ^ 3 * g) }
  end,
}
