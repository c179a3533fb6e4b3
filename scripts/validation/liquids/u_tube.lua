-- Water in a U tube swings: a tank that a wall divides but for a gap above its floor. The period is that of a column as
-- long as its kinetic energy says, which the potential flow round the bend gives.
local tank = require("_tank")
local validation = require("validation")

local g, wall, gap, d, a, step = 9.81, 0.2, 0.4, 0.8, 0.04, 0.005 -- m/s^2, m: wall's thickness, gap, depth, rise; s
local width = (1 - wall) / 2

-- m: of the column that would have the same kinetic energy: sum of phi over the surface by the flux, phi solved on m cells a metre
-- by over-relaxation in half the tank (phi = 0 in the middle of the gap, flux 1 through the surface).
local function length(m)
  local nx, nz = math.floor(m / 2 + 0.5), math.floor(d * m + 0.5)
  local open, left = math.floor(gap * m + 0.5), math.floor(width * m + 0.5)
  local phi = {}
  for i = 0, nx - 1 do
    phi[i] = {}
    for k = 0, nz - 1 do phi[i][k] = 0 end
  end
  local function is_water(i, k) return i >= 0 and k >= 0 and k < nz and i < nx and (i < left or k < open) end
  for _ = 1, 20 * m do
    for i = 0, nx - 1 do
      for k = 0, nz - 1 do
        if is_water(i, k) then
          local sum, count = 0, 0
          if is_water(i - 1, k) then sum, count = sum + phi[i - 1][k], count + 1 end
          if is_water(i + 1, k) then sum, count = sum + phi[i + 1][k], count + 1 end
          if is_water(i, k - 1) then sum, count = sum + phi[i][k - 1], count + 1 end
          if is_water(i, k + 1) then sum, count = sum + phi[i][k + 1], count + 1 end
          if i == nx - 1 then count = count + 2 end
          if k == nz - 1 then sum = sum + 1 / m end
          phi[i][k] = phi[i][k] + 1.9 * (sum / count - phi[i][k])
        end
      end
    end
  end
  local mean = 0
  for i = 0, left - 1 do mean = mean + phi[i][nz - 1] / left end
  return 2 * (mean + 0.5 / m)
end

return validation.problem {
  title = "A U tube",
  quantities = { { name = "period", unit = "s", reference = function()
    local coarse, fine = length(10), length(20)
    return 2 * math.pi * math.sqrt((fine + (fine - coarse) / (2 ^ (4 / 3) - 1)) / (2 * g)) -- corners of 270 degrees: h^(4/3)
  end, source = "2 pi sqrt(L/(2 g)), L by Laplace's equation for the flow round the bend" } },
  space = { 20, 30, 40 },
  noise = 0.01,
  tolerance = 0.01,
  why = "corners leave 0.5 % of the length; a rise of 0.8 to 1.6 cells and the places of particles leave 0.3 % of the period",
  quick = { space = { 10, 12, 15 }, tolerance = 0.05 },
  solve = function(at)
    local scene, count, masses = tank.scene { n = at.n, h = step, top = d + 0.1, room = d + 0.2, g = g, scatter = 0, duration = 4,
      level = function(x) return d + (x < 0.5 and a or -a) end,
      inside = function(x, _, z) return math.abs(x - 0.5) > wall / 2 or z < gap end,
      before = function(s)
        s:corrector("obstacle", { shape = "box", size = { wall, 1, 2 }, position = { 0.5, 0, gap + 1 } })
      end }
    local zero = validation.crossings(1)
    validation.each(scene, step, 4 / step, function(state, t)
      local y, slope = 0, 0
      for id = 1, count do
        y = y + masses[id] * (state:position(id)[1] - 0.5)
        slope = slope + masses[id] * state:velocity(id)[1]
      end
      return zero(t, y, slope) > 1
    end)
    return zero.times[2] - zero.times[1]
  end,
}
