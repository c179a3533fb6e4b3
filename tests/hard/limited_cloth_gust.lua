--[[
what: a cloth whose threads may neither stretch nor shrink, held by corrections alone, in gusts across its upper edge
right: Lagrange's equations of one thread as a chain of links, by Runge's and Kutta's method (scripts/lib/links.lua)
must: leapfrog, stoermer, rk4, dopri5, bdf2
also: leapfrog dt=1/60; leapfrog dt=1/480; symplectic_euler dt=1/240; rk4 dt=1/240; euler dt=1e-3
]]
-- The bound: a hundredth of the cloth's height. All three threads move alike, so the weft between them has no part.
local links = require("links")
local columns, n, L, m, d, g = 3, 4, 0.25, 0.02, 0.01, 9.81
local scene = hooke.scene { duration = 1, fps = 60, tol = 1e-7, accuracy = 0.01 }
local gust = hooke.gust { mean = { 5, 0, 0 }, amplitude = { 4, 0, 1 }, shortest = 0.2, longest = 1, seed = 5 }

local warp, weft, top = {}, {}, {}
for k = 0, n do
  for i = 1, columns do
    local id = scene:particle { position = { 0, i * L, -k * L }, mass = m }
    if k == 0 then top[i] = id else warp[#warp + 1] = { id - columns, id } end
    if i > 1 then weft[#weft + 1] = { id - 1, id } end
  end
end
scene:pin(top)
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("wind", { on = "particles", d = d, velocity = gust })
scene:force("springs", { edges = weft, k = 10 })
scene:corrector("strain_limit", { edges = warp, limit = 0, compression = 0 })

local swing = links.pendulum { n = n, length = L, mass = m, g = g, angle = 0, h = 2e-3, drag = d,
  wind = function(t)
    local u = { gust(t) }
    return u[1], u[3]
  end }
scene:exact(function(t)
  local list, places = {}, swing(t)
  for k = 0, n do
    for i = 1, columns do
      local p = k == 0 and { 0, 0 } or places[k]
      list[#list + 1], list[#list + 2], list[#list + 3] = p[1], i * L, p[2]
    end
  end
  return table.unpack(list)
end)
return scene
