-- The ribbon of heavy_ribbon.lua as a membrane of triangles: clamped level at one end it bends under its own weight as
-- the heavy elastica does, with EI = (1 - nu^2) B per width; nu of hinges is -1/3. It is one cell of n wide, so its width
-- shrinks with n: what the clamp, which is wider than a point, holds back is of order 1.
local validation = require("validation")
local numerics = require("numerics")

local density, B, L = 0.15, 1e-4, 0.08
local EI = 8 / 9 * B
local source = "the heavy elastica, d2 theta/ds2 = -w L^3/EI (1 - s) cos(theta), by shooting"

-- Where the tip of a heavy elastica of length 1 is: x and the drop.
local function tip(load)
  local function shoot(slope)
    return numerics.ode(function(s, y)
      return { y[2], -load * (1 - s) * math.cos(y[1]), math.cos(y[1]), math.sin(y[1]) }
    end, 0, { 0, slope, 0, 0 }, 1)
  end
  local slope = numerics.root(function(k) return shoot(k)[2] end, 0, load)
  local y = shoot(slope)
  return y[3], y[4]
end

-- The same for a ribbon of n cells, the clamp in the middle of the first one.
local function ribbon(n, load)
  local gravity = load * EI / (density * L ^ 3)
  local a = L / (n - 0.5)
  local scene = hooke.scene { duration = 30, fps = 4, dt = 1 / 200, integrator = "backward_euler" }
  local cloth = scene:grid { nx = n + 1, ny = 2, width = n * a, height = a, origin = { -a / 2, 0, 0 },
    density = density, alternating = true }
  scene:pin { cloth:at(1, 1), cloth:at(2, 1), cloth:at(1, 2), cloth:at(2, 2) }
  scene:force("membrane", { triangles = cloth:triangles(), model = "stvk", stiffness = 500, nu = 0.3, damping = 1e-4 })
  scene:force("hinges", { rigidity = B, damping = 0.02 * B })
  scene:force("drag", { rate = 20 })
  scene:force("gravity", { g = { 0, 0, -gravity } })
  local s = validation.rest(scene, 0.25, 1e-9, 30):state()
  local p, q = s:position(cloth:at(n + 1, 1)), s:position(cloth:at(n + 1, 2))
  return (p[1] + q[1]) / (2 * L), -(p[3] + q[3]) / (2 * L)
end

return validation.problem {
  title = "Membrane and hinges: ribbon under its own weight",
  quantities = {
    { name = "drop/L at w L^3/EI = 1", unit = "", source = source,
      reference = function() return select(2, tip(1)) end },
    { name = "drop/L at w L^3/EI = 5", unit = "", source = source,
      reference = function() return select(2, tip(5)) end },
    { name = "Peirce's angle at 8.0042", unit = "degrees", reference = 41.5,
      source = "Peirce, J. Textile Institute 21 (1930), his w L^3/EI = 8 recomputed" },
  },
  space = { 20, 40, 80 },
  order = { space = 1 },
  tolerance = 5e-3,
  why = "errors of order 1, 2 % at n = 80, leave those of order 2, (1/80)^2 times some tens",
  noise = 1e-7,
  forces = { membrane = { "triangles", "stiffness", "damping" }, hinges = { "rigidity", "damping" } },
  quick = { space = { 4, 6, 8 }, tolerance = 0.2 },
  solve = function(at)
    local x, drop = ribbon(at.n, 8.00420)
    return { select(2, ribbon(at.n, 1)), select(2, ribbon(at.n, 5)), math.deg(math.atan(drop, x)) }
  end,
}
