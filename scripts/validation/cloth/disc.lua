-- A disc of soft sheet on a smaller round table, Cusick's test, where the part beyond the table is held out by its own
-- rigidity and stays round: the drape coefficient, the part of the ring that its shadow covers, and how far the rim
-- sinks. The reference is the least energy of a surface of revolution, from its Euler equations by shooting: Green's
-- strains of the meridian and of the circles, the curvatures of both, nu = -1/3 of hinges for them, and the weight.
-- Triangles are equilateral but for the bend: rings whose radii grow in proportion, n corners each.
local validation = require("validation")

local b, c, density, g = 0.15, 0.09, 0.15, 9.81
local B, Y, nu = 2e-4, 2, 0.3
local C11, C12, bend = Y / (1 - nu ^ 2), Y * nu / (1 - nu ^ 2), -1 / 3

-- The stretch of the meridian with the stress P, N/m, where circles are stretched by `around`; and the stress of these.
local function stretch(P, around)
  local E, s = (around ^ 2 - 1) / 2, 1
  for _ = 1, 30 do
    local S = C11 * (s ^ 2 - 1) / 2 + C12 * E
    s = s - (s * S - P) / (S + s ^ 2 * C11)
  end
  return s, around * (C11 * E + C12 * (s ^ 2 - 1) / 2)
end

-- By fourth-order steps from the table: y = { slope, its rate, r, z, s times the horizontal stress }.
local function rate(s, y)
  local load, cos, sin = density * g * (b ^ 2 - s ^ 2) / 2, math.cos(y[1]), math.sin(y[1])
  local along, hoop = stretch((y[5] * cos + load * sin) / s, y[3] / s)
  local turn = (cos * sin / s - y[2] + along * (y[5] * sin - load * cos) / B) / s
  return { y[2], turn, along * cos, -along * sin, hoop }
end

local function shoot(bent, pull)
  local y, steps = { 0, bent, c, 0, pull }, 400
  local h = (b - c) / steps
  local function moved(k, part)
    local out = {}
    for i = 1, 5 do out[i] = y[i] + part * k[i] end
    return out
  end
  for k = 0, steps - 1 do
    local s = c + k * h
    local k1 = rate(s, y)
    local k2 = rate(s + h / 2, moved(k1, h / 2))
    local k3 = rate(s + h / 2, moved(k2, h / 2))
    local k4 = rate(s + h, moved(k3, h))
    for i = 1, 5 do y[i] = y[i] + h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]) end
  end
  return y[2] + bend * math.sin(y[1]) / b, y[5], y
end

-- Newton's iteration for no moment and no pull at the rim.
local reference
local function least_energy()
  if reference then return reference end
  local p, q, y = density * g * (b - c) ^ 2 / (2 * B), 0.01, {}
  for _ = 1, 40 do
    local f, k, now = shoot(p, q)
    local e = 1e-6
    local f_p, k_p = shoot(p + e, q)
    local f_q, k_q = shoot(p, q + e)
    local a11, a12, a21, a22 = (f_p - f) / e, (f_q - f) / e, (k_p - k) / e, (k_q - k) / e
    y = now
    local det = a11 * a22 - a12 * a21
    p, q = p - (f * a22 - k * a12) / det, q - (k * a11 - f * a21) / det
  end
  reference = { (y[3] ^ 2 - c ^ 2) / (b ^ 2 - c ^ 2), -y[4] }
  return reference
end

-- Rings from one inside of the table on, which ends in the middle of the first cell, as a clamp does. With fewer or more
-- rings than fit n the triangles are flat or tall, and hinges have another rigidity (an eighth: rim 9 % lower).
local function disc(n)
  local rings = math.floor(math.log(b / c) / (2 * math.pi / n * math.sqrt(3) / 2))
  local part = math.log(b / c) / (rings + 0.5)
  local scene = hooke.scene { duration = 60, fps = 2, dt = 0.05, integrator = "backward_euler" }
  local vertices, faces, inner, rim = {}, {}, {}, {}
  for j = -1, rings do
    local r = c * math.exp(part * (j + 0.5))
    for i = 0, n - 1 do
      local angle = 2 * math.pi * (i + j % 2 / 2) / n
      vertices[#vertices + 1] = { r * math.cos(angle), r * math.sin(angle), 0 }
    end
  end
  local function id(i, j) return (j + 1) * n + i % n + 1 end
  for j = -1, rings - 1 do
    for i = 0, n - 1 do
      local s = j % 2
      faces[#faces + 1] = { id(i, j), id(i + 1, j), id(i + s, j + 1) }
      faces[#faces + 1] = { id(i + 1 - s, j), id(i + 1, j + 1), id(i, j + 1) }
    end
  end
  local cloth = scene:mesh { vertices = vertices, faces = faces, density = density }
  for i = 0, n - 1 do
    inner[#inner + 1], inner[#inner + 2] = cloth:at(id(i, -1)), cloth:at(id(i, 0))
    rim[i + 1] = cloth:at(id(i, rings))
  end
  scene:pin(inner)
  scene:force("membrane", { triangles = cloth:triangles(), model = "stvk", stiffness = Y, nu = nu })
  scene:force("hinges", { rigidity = B, damping = 0.02 * B })
  scene:force("drag", { rate = 20 })
  scene:force("gravity", { g = { 0, 0, -g } })
  local s, square, z = validation.rest(scene, 0.5, 1e-8, 60):state(), 0, 0
  for _, k in ipairs(rim) do
    local p = s:position(k)
    square, z = square + (p[1] ^ 2 + p[2] ^ 2) / n, z + p[3] / n
  end
  return (square - c ^ 2) / (b ^ 2 - c ^ 2), -z
end

return validation.problem {
  title = "A round sheet on a round table, Cusick's drape coefficient",
  quantities = {
    { name = "drape coefficient", reference = function() return least_energy()[1] end,
      source = "least energy of a surface of revolution, by shooting; Cusick, J. Textile Institute 56 (1965)" },
    { name = "rim sinks by", unit = "m", reference = function() return least_energy()[2] end,
      source = "least energy of a surface of revolution, by shooting" },
  },
  space = { 37, 80, 165 },
  tolerance = 5e-3,
  why = "errors of order 1 to 2, 2e-3 of the rim at n = 165; levels are those at which triangles are equilateral to 1 %",
  noise = 1e-6,
  forces = { hinges = { "rigidity", "damping" } },
  quick = { space = { 16, 37, 59 }, tolerance = 5e-2 },
  solve = function(at) return { disc(at.n) } end,
}
