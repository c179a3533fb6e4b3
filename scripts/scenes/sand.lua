-- sand.lua: sand runs out of a funnel onto the floor and comes to rest as a heap. The slope is the angle of repose, which
-- grows with the friction: try friction=0.1. Grains do not turn, as those of real sand hardly do.
local n = param("n", 1000, "grains", { min = 10, max = 1e6 })
local friction = param("friction", 0.5, "coefficient of friction", { min = 0 })
local R, k = 0.01, 5e3 -- m; N/m: overlaps of 3 % of the radius at rest
local neck, slope, up = 0.095, 0.8, 0.25 -- of the funnel: radius and height above the floor, m; m of radius per m

local scene = hooke.scene { duration = 2, fps = 30 }
scene:channel("radius", { initial = R })
scene:channel("tint", { initial = { 1, 1, 1 } })
scene:service("neighbours", { skin = 0.25 })

local bands = { { 0.93, 0.79, 0.53 }, { 0.76, 0.42, 0.24 } }
local filled, layer, gap = 0, 1, 2.4 * R
while filled < n do
  local h = gap * layer
  local across = math.floor((neck + slope * h - 2 * R) / gap)
  for a = -across, across do
    for b = -across, across do
      if a * a + b * b <= across * across and filled < n then
        local r = R * (0.85 + 0.3 * math.random())
        local function shaken(at) return gap * at + 0.2 * R * (math.random() - 0.5) end
        scene:particle { position = { shaken(a), shaken(b), up + h }, radius = r, mass = 1e4 / 3 * math.pi * r ^ 3,
          tint = bands[1 + layer // 2 % 2] } -- of 2,500 kg/m^3
        filled = filled + 1
      end
    end
  end
  layer = layer + 1
end

scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("soft_spheres", { radii = "radius", stiffness = k, restitution = 0.5, friction = friction })
scene:force("soft_walls", { radii = "radius", stiffness = k, restitution = 0.5, friction = 0.5, label = "floor" })
scene:force("soft_walls", { radii = "radius", stiffness = k, restitution = 0.5, friction = 0.2, label = "funnel",
  funnel = { 0, 0, up, neck, slope } })

scene:measure("slope", function(s) -- degrees: a cone's mean height and distance from the axis are H/4 and B/2
  local z, p = 0, 0
  for _, id in ipairs(s:ids()) do
    local at = s:position(id)
    if at[3] < up / 2 then z, p = z + at[3] - R, p + math.sqrt(at[1] ^ 2 + at[2] ^ 2) end
  end
  return p > 0 and math.deg(math.atan(2 * z, p)) or 0
end, { unit = "degrees" })
scene:output("frames", { color = "tint", radius = R, from = { 0.6, -1.1, 0.55 }, look_at = { 0, 0, 0.19 } })
return scene
