-- hourglass.lua: sand runs through the neck of an hourglass at a steady rate, whatever stands above it, and bands of
-- colour show how it flows: the middle first. The rate is near that of Beverloo and others (1961) for spheres of the
-- diameter d and a neck of D, 0.58 rho sqrt(g) (D - 1.4 d)^2.5 kg/s, rho = 1,500 kg/m^3: 1,600 grains a second; in a
-- steep glass it is higher.
local n = param("n", 1200, "grains", { min = 10, max = 1e6 })
local neck = param("neck", 0.08, "radius of the neck, m", { min = 0.02, max = 0.2 })
local R, k, slope, up = 0.01, 5e3, 0.5, 0.35 -- m; N/m; of the glass: m of radius per m, height of the neck

local scene = hooke.scene { duration = 1.5, fps = 30 }
scene:channel("radius", { initial = R })
scene:channel("tint", { initial = { 1, 1, 1 } })
scene:channel("spin", { size = 3 })
scene:service("neighbours", { skin = 0.25 })

local bands = { { 0.16, 0.42, 0.55 }, { 0.94, 0.87, 0.72 }, { 0.85, 0.45, 0.27 } }
local ids, layer, gap = {}, 1, 2.4 * R
while #ids < n do
  local h = gap * layer
  local across = math.floor((neck + slope * h - 2 * R) / gap)
  for a = -across, across do
    for b = -across, across do
      if a * a + b * b <= across * across and #ids < n then
        local r = R * (0.85 + 0.3 * math.random())
        local function shaken(at) return gap * at + 0.2 * R * (math.random() - 0.5) end
        ids[#ids + 1] = scene:particle { position = { shaken(a), shaken(b), up + h }, radius = r,
          mass = 1e4 / 3 * math.pi * r ^ 3, tint = bands[1 + layer // 4 % 3] } -- of 2,500 kg/m^3
      end
    end
  end
  layer = layer + 1
end

local law = { radii = "radius", spin = "spin", stiffness = k, restitution = 0.5, friction = 0.4 }
local glass = { radii = "radius", spin = "spin", stiffness = k, restitution = 0.5, friction = 0.2, label = "glass",
  planes = { 0, 0, 1, 0 }, funnel = { 0, 0, up, neck, slope } }
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("soft_spheres", law)
scene:force("soft_walls", glass)

local at = {} -- s, when each quarter had fallen
local function quarters(s)
  local fallen = 0
  for _, id in ipairs(ids) do
    if s:position(id)[3] < up then fallen = fallen + 1 end
  end
  for q = #at + 1, 4 * fallen // n do at[q] = s.t end
  return fallen
end
scene:measure("fallen", quarters)
scene:measure("rate", function() return at[3] and at[3] > at[1] and n / 2 / (at[3] - at[1]) or 0 end, { unit = "1/s" }) -- grains a second
scene:output("frames", { color = "tint", radius = R, from = { 0.3, -1.6, 0.5 }, look_at = { 0, 0, 0.33 } })
return scene
