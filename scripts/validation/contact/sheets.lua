-- Sheets slide at mu: on a slope of triangles with g (sin a - mu cos a) or not at all, and over a larger sheet that lies
-- on a floor until friction has stopped them, v^2/(2 mu g) after a push; the lower one stays, since the floor holds it by
-- twice as much. What is told is of the middle of all corners. In the longest of these steps the upper sheet passes four
-- times its thickness.
local validation = require("validation")
local sheets = require("_sheets")

local g, a, thickness, mu, push = 9.81, math.atan(1 / 2), 1e-3, 0.35, 12
local down, off = { math.cos(a), 0, -math.sin(a) }, { math.sin(a), 0, math.cos(a) }

-- Pushed for 0.1 s against friction, and stopped by it.
local v = (push - mu * g) * 0.1
local distance = v * 0.1 / 2 + v * v / (2 * mu * g)

local function acceleration(coefficient) return g * (math.sin(a) - coefficient * math.cos(a)) end

-- Acceleration and speed on a slope.
local function sliding(h, coefficient)
  local scene = hooke.scene { duration = 0.5, fps = 4, dt = h, integrator = "leapfrog" }
  scene:body { shape = "box", size = { 8, 1, 0.1 }, position = { -0.05 * off[1], 0, -0.05 * off[3] }, orientation = { 0, a, 0 } }
  local gap = thickness / 2
  local ids = sheets.add(scene, { nx = 5, size = 0.2, density = 0.2, damping = 0.01, u = down,
    origin = { gap * off[1], 0.13, gap * off[3] } })
  scene:force("gravity", { g = { 0, 0, -g } })
  scene:corrector("contact", { friction = coefficient, thickness = thickness })
  local _, before = sheets.mean(scene:run { to = 0.25 }:state(), ids, down)
  local _, after = sheets.mean(scene:run():state(), ids, down)
  return (after - before) / 0.25, after
end

-- How far the upper and the lower sheet come.
local function thrown(h)
  local scene = hooke.scene { duration = 0.4, fps = 10, dt = h, integrator = "leapfrog" }
  scene:body { shape = "box", size = { 4, 4, 0.1 }, position = { 0, 0, -0.05 } }
  local lower = sheets.add(scene, { nx = 6, size = 0.5, density = 0.2, damping = 0.01, origin = { -0.1, -0.2, thickness / 2 } })
  local upper = sheets.add(scene, { nx = 5, size = 0.2, density = 0.2, damping = 0.01, origin = { 0.013, 0.007, 1.5 * thickness } })
  sheets.push(scene, upper, { push, 0, 0 }, 0.1)
  scene:force("gravity", { g = { 0, 0, -g } })
  scene:corrector("contact", { friction = mu, thickness = thickness })
  local start, x = scene:run { to = 0 }:state(), { 1, 0, 0 }
  local u0, l0 = sheets.mean(start, upper, x), sheets.mean(start, lower, x)
  local s = scene:run():state()
  return sheets.mean(s, upper, x) - u0, sheets.mean(s, lower, x) - l0
end

return validation.problem {
  title = "Sheets that slide, on a slope and on a sheet",
  quantities = {
    { name = "acceleration, mu = 0.3", unit = "m/s^2", reference = acceleration(0.3), source = "Coulomb: g (sin a - mu cos a)" },
    { name = "acceleration, mu = 0.495", unit = "m/s^2", reference = acceleration(0.495), source = "Coulomb: g (sin a - mu cos a)" },
    { name = "speed, mu = 0.505", unit = "m/s", reference = 0, scale = 1, source = "Coulomb: it sticks" },
    { name = "distance over a sheet", unit = "m", reference = distance, source = "Coulomb: v 0.1 s/2 + v^2/(2 mu g)",
      tolerance = 3e-3, why = "sweeps leave overlaps of up to a hundredth of the thickness, which lift what passes over corners" },
    { name = "way of the lower sheet", unit = "m", reference = 0, scale = distance,
      source = "Coulomb: the floor holds it", tolerance = 1e-4,
      why = "what sweeps leave" },
  },
  time = { 1 / 250, 1 / 500, 1 / 1000 },
  noise = 1e-3,
  tolerance = 1e-4,
  why = "what sweeps leave",
  quick = { time = { 1 / 250, 1 / 300, 1 / 400 } },
  solve = function(at)
    local a1 = sliding(at.h, 0.3)
    local a2 = sliding(at.h, 0.495)
    local _, speed = sliding(at.h, 0.505)
    return { a1, a2, speed, thrown(at.h) }
  end,
}
