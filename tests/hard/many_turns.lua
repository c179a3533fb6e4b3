--[[
what: a straight rod whose clamp was turned forty times, which its shape does not show, swings by a thousandth of an edge
right: closed form, linear: three free edges between walls bend, and by its shape the twist loses (z1 x z2)/l^2
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, arkode, cvode, implicit_midpoint,
  implicit_trapezoid, tr_bdf2, esdirk4
]]
-- The bound: a tenth of the swing after five periods; one turn less of forty makes them shorter by 3 %.
local l, EI, GJ, m, turns, A = 0.1, 1e-3, 5e-5, 1e-3, 40, 1e-4
local M = GJ * 2 * math.pi * turns / (3 * l) -- torque
-- Stiffness ((a, c + i d), (c - i d, a)) for y + i z: joints of EI/l, at the walls of twice that, and -M/l^2 (z1 x z2)
local a, c, d = 7 * EI / l ^ 3, -4 * EI / l ^ 3, M / l ^ 2
local size = math.sqrt(c * c + d * d)
local w = math.sqrt((a - size) / m)
local scene = hooke.scene { duration = 5 * 2 * math.pi / w, fps = 200, accuracy = 1e-5 }

-- The softer mode: z1 = A, z2 = -A size/(c + i d)
local shape = { { 0, 0 }, { 0, 0 }, { A, 0 }, { -A * c / size, A * d / size }, { 0, 0 }, { 0, 0 } }
local edges = {}
for i, z in ipairs(shape) do
  scene:particle { position = { l * i, z[1], z[2] }, mass = m }
  if i > 1 then edges[i - 1] = { i - 1, i } end
end
scene:pin { 1, 2, 5, 6 }
scene:pin({ 3, 4 }, { normal = { 1, 0, 0 } })
scene:force("rods", { edges = edges, EI = EI, GJ = GJ, rest = "straight", turn = 2 * math.pi * turns })

scene:exact(function(t)
  local answer = {}
  for i, z in ipairs(shape) do
    local cosine = math.cos(w * t)
    answer[3 * i - 2], answer[3 * i - 1], answer[3 * i] = l * i, z[1] * cosine, z[2] * cosine
  end
  return table.unpack(answer)
end)
return scene
