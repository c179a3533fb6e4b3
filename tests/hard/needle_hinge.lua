--[[
what: two wings on bars, of 1 m and of 1 cm: the short one rings at 100 times the pace of the long one
right: theta = A sin(w t), w^2 = k/(m r^2), of each wing
must: leapfrog, rk4, dopri5
also: leapfrog; leapfrog dt=1e-4; rk4; dopri5; implicit_midpoint dt=1e-3; bdf2 dt=1e-3
]]
-- The bound: a hundredth of the long wing's amplitude of 0.1 m. The short one moves by 1 mm, a third of the bound in
-- the mean over ten particles, and need not be followed.
local scene = hooke.scene { duration = 0.4, fps = 50, accuracy = 1e-3 }

-- Both on the edge of 2 m along y, with their feet at its middle, each with its own fixed wing across, of 1 m.
local function wing(x, r, angle)
  local places = { { x, -1, 0 }, { x, 1, 0 }, { x - 1, 0, 0 }, { x + r, 0, 0 }, { x, 0, 0 } }
  local a, b, c, d, foot = table.unpack(scene:particles({ positions = places, mass = 1 }):ids())
  scene:pin { a, b, c, foot }
  scene:constraint("bars", { edges = { { foot, d } }, label = "bar" .. x })
  local function own(height) return (6 + 2 * height ^ 2) / (6 * height) end -- sides 2, sqrt(1 + height^2) twice
  local k = 2 / (1 / own(1) + 1 / own(r))
  scene:force("hinges", { hinges = { { a, b, c, d } }, rigidity = 1 / k, rest = angle, label = "hinge" .. x })
  return function(t)
    local theta = angle * (1 - math.cos(t / r))
    return x, -1, 0, x, 1, 0, x - 1, 0, 0, x + r * math.cos(theta), 0, -r * math.sin(theta), x, 0, 0
  end
end

local long, short = wing(0, 1, 0.1), wing(5, 1e-2, 0.1)
scene:exact(function(t)
  local list = { long(t) }
  for _, v in ipairs { short(t) } do list[#list + 1] = v end
  return table.unpack(list)
end)
return scene
