-- A crank turns a rocker by a coupler, under gravity: a plane loop of three bodies in space, of whose equations three follow from
-- the others. It has one freedom, the crank's angle, so that the time of a turn is the integral of sqrt(M/(2 (E - V))), with the
-- bodies' moment of inertia M as the crank feels it (Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems I, 1989).
local validation = require("validation")
local numerics = require("numerics")

local a, b, c, ground = 0.3, 0.8, 0.6, 0.9 -- m: crank, coupler, rocker, distance of the axles
local mass, g, w = { 2, 1, 1.5 }, 9.81, 8 -- kg, m/s^2, rad/s

local function inertia(k, length) return mass[k] * (length ^ 2 + 0.05 ^ 2) / 12 end

-- The turns of the three at the crank's angle, and their rates by it, from the triangle of the coupler and the rocker.
local function turns(angle)
  local x, y = ground - a * math.cos(angle), -a * math.sin(angle)
  local reach = math.sqrt(x * x + y * y)
  local coupler = math.atan(y, x) + math.acos((b * b + reach * reach - c * c) / (2 * b * reach))
  local X, Y = b * math.cos(coupler) - x, b * math.sin(coupler) - y
  local rocker = math.atan(Y, X)
  local s = math.sin(coupler - rocker)
  return { angle, coupler, rocker }, { 1, -a / b * math.sin(angle - rocker) / s, a / c * math.sin(coupler - angle) / s }
end

-- Centres of the three, and their velocities where the crank turns at 1 rad/s.
local function centers(angle)
  local t, u = turns(angle)
  local function half(k, l) return l / 2 * math.cos(t[k]), l / 2 * math.sin(t[k]) end
  local ax, ay = half(1, a)
  local bx, by = half(2, b)
  local cx, cy = half(3, c)
  return { { ax, ay }, { 2 * ax + bx, 2 * ay + by }, { ground + cx, cy } },
    { { -ay, ax }, { -2 * ay - u[2] * by, 2 * ax + u[2] * bx }, { -u[3] * cy, u[3] * cx } }, t, u
end

local lengths = { a, b, c }
local function energies(angle)
  local at, v, _, u = centers(angle)
  local M, V = 0, 0
  for k = 1, 3 do
    M = M + mass[k] * (v[k][1] ^ 2 + v[k][2] ^ 2) + inertia(k, lengths[k]) * u[k] ^ 2
    V = V + mass[k] * g * at[k][2]
  end
  return M, V
end

local function reference()
  local M, V = energies(0)
  local E = M * w * w / 2 + V
  return numerics.integrate(function(angle)
    local m, v = energies(angle)
    return math.sqrt(m / (2 * (E - v)))
  end, 0, 2 * math.pi)
end

return validation.problem {
  title = "A turn of a four-bar linkage",
  quantities = { { name = "time of a turn", unit = "s", reference = reference, source = "integral of sqrt(M/(2 (E - V)))" } },
  time = { 0.004, 0.002, 0.001 },
  order = { time = 2 },
  tolerance = 1e-7,
  why = "errors of order 2 leave those of order 4",
  quick = { time = { 0.01, 0.005, 0.0025 }, tolerance = 1e-3 },
  solve = function(at)
    local steps = math.ceil(1.6 / at.h)
    local scene = hooke.scene { duration = steps * at.h, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local place, v, t, u = centers(0)
    local body = {}
    for k = 1, 3 do
      body[k] = scene:rigid { shape = "box", size = { lengths[k], 0.05, 0.05 }, mass = mass[k], orientation = { 0, 0, t[k] },
        position = { place[k][1], place[k][2], 0 }, velocity = { w * v[k][1], w * v[k][2], 0 }, spin = { 0, 0, w * u[k] } }
    end
    local axis = { 0, 0, 1 }
    scene:joint { kind = "hinge", a = body[1], at = { 0, 0, 0 }, axis = axis }
    scene:joint { kind = "hinge", a = body[2], b = body[1], at = { a, 0, 0 }, axis = axis }
    scene:joint { kind = "hinge", a = body[3], b = body[2], axis = axis,
      at = { ground + c * math.cos(t[3]), c * math.sin(t[3]), 0 } }
    scene:joint { kind = "hinge", a = body[3], at = { ground, 0, 0 }, axis = axis }
    scene:force("gravity", { g = { 0, -g, 0 } })
    local rises = validation.crossings(1)
    validation.each(scene, at.h, steps, function(s, now)
      if now > 0.1 then rises(now, body[1]:position(s)[2], body[1]:velocity(s)[2]) end
    end)
    return rises.times[1]
  end,
}
