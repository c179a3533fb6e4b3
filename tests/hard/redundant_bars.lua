--[[
what: a tetrahedron of bars with a fifth particle in its middle, one bar more than holds it rigid and three given twice
right: closed form, a spherical top turns uniformly while it falls
must: leapfrog, stoermer5, rk4, dopri5, midpoint, implicit_midpoint, bdf2, esdirk4
]]
-- The bound: leapfrog's (h w)^2/24 w T = 4e-4 rad at h = 1/200 s, on a radius of 1.7 m; ten times that.
local g, w, T = 9.81, { 2, -3, 4 }, 1.5
local scene = hooke.scene { duration = T, fps = 200, accuracy = 1e-2 }
local corner = { { 1, 1, 1 }, { 1, -1, -1 }, { -1, 1, -1 }, { -1, -1, 1 }, { 0, 0, 0 } }
local edges, velocities = { { 1, 2 }, { 4, 3 }, { 5, 1 } }, {}
for i, x in ipairs(corner) do
  for j = 1, i - 1 do edges[#edges + 1] = { j, i } end
  velocities[i] = { w[2] * x[3] - w[3] * x[2], w[3] * x[1] - w[1] * x[3], w[1] * x[2] - w[2] * x[1] }
end
scene:particles { positions = corner, velocities = velocities, mass = 0.5 }
scene:force("gravity", { g = { 0, 0, -g } })
scene:constraint("bars", { edges = edges })
scene:exact(function(t) -- Rodrigues' formula
  local speed, at = math.sqrt(w[1] ^ 2 + w[2] ^ 2 + w[3] ^ 2), {}
  local c, s = math.cos(speed * t), math.sin(speed * t) / speed
  for i, x in ipairs(corner) do
    local along = (w[1] * x[1] + w[2] * x[2] + w[3] * x[3]) * (1 - c) / speed ^ 2
    for a = 1, 3 do at[#at + 1] = c * x[a] + s * velocities[i][a] + along * w[a] end
    at[#at] = at[#at] - g * t * t / 2
  end
  return table.unpack(at)
end)
return scene
