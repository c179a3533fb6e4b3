-- sand.lua: a column of grains falls onto the floor and comes to rest as a heap. Its slope is the angle of repose, which
-- grows with the friction: try friction=0.1. Grains do not turn, as those of real sand hardly do, and differ in size.
local n = param("n", 2000, "grains", { min = 10, max = 1e6 })
local friction = param("friction", 0.4, "coefficient of friction", { min = 0 })
local R, k = 0.01, 5e3 -- m, N/m: overlaps of 3 % of the radius under the heap

local scene = hooke.scene { duration = 2.5, fps = 30 }
scene:channel("radius", { initial = R })

local across, gap = math.max(2, math.floor((n / 25) ^ (1 / 3))), 2.5 * R -- from the axis; the column is 8 times as high
local i, layer = 0, 1
while i < n do
  for a = -across, across do
    for b = -across, across do
      if a * a + b * b <= across * across and i < n then
        local r = R * (0.8 + 0.4 * math.random())
        local function shaken(at) return gap * at + 0.4 * R * (math.random() - 0.5) end
        scene:particle { position = { shaken(a), shaken(b), shaken(layer) }, radius = r, mass = 2500 * 4 / 3 * math.pi * r ^ 3 }
        i = i + 1
      end
    end
  end
  layer = layer + 1
end

scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("soft_spheres", { radii = "radius", stiffness = k, restitution = 0.5, friction = friction })
scene:force("soft_walls", { radii = "radius", stiffness = k, restitution = 0.5, friction = 0.5, label = "floor" })

scene:measure("slope", function(s) -- degrees: a cone's mean height and distance from the axis are H/4 and B/2
  local z, p = 0, 0
  for _, id in ipairs(s:ids()) do
    local at = s:position(id)
    z, p = z + at[3] - R, p + math.sqrt(at[1] ^ 2 + at[2] ^ 2)
  end
  return math.deg(math.atan(2 * z, p))
end)
scene:output("frames", { color = "speed", range = { 0, 2 }, radius = R })
return scene
