-- tautochrone.lua: beads slide on two wires from several heights. On the cycloid in front all of them swing with one
-- period and meet at the bottom again and again (Huygens 1673); on the circle behind it, a pendulum's path, those from
-- above come late. The wires are constraints: a function of the script, and a circle. `spread` is the time between the
-- first and the last bead of a wire at the bottom, which all reach after pi sqrt(a/g) on the cycloid.
local a = param("a", 0.5, "radius of the wheel that draws the cycloid, m", { min = 0.01 })
local T = param("duration", 6, "s", { min = 0.1 })

local g, starts = 9.81, { 0.5, 1, 1.5, 2, 2.5 } -- p, from the bottom
local scene = hooke.scene { duration = T, fps = 60, integrator = "leapfrog", dt = 1 / 960 }

-- x = a (p + sin p), z = a (1 - cos p); p of x by Newton's iteration
local function angle(x)
  local p = x / (2 * a)
  for _ = 1, 30 do
    local step = (p + math.sin(p) - x / a) / (1 + math.cos(p))
    p = p - step
    if math.abs(step) < 1e-15 then break end
  end
  return p
end
local function cycloid(p) return { a * (p + math.sin(p)), 0, a * (1 - math.cos(p)) } end
-- The circle of the same curvature at the bottom, to the same heights.
local function circle(p)
  local c = 1 - (1 - math.cos(p)) / 4
  return { 4 * a * math.sqrt(1 - c * c) * (p < 0 and -1 or 1), 1, 4 * a * (1 - c) }
end

local beads, edges = {}, {}
local function wire(curve, name)
  local list, last = {}, nil
  for k, p in ipairs(starts) do list[k] = scene:particle { position = curve(p), mass = 1, group = "bead " .. k } end
  for k = -60, 60 do -- what one sees of it: light particles that nothing pulls
    local id = scene:particle { position = curve(k / 22), mass = 1e-3, group = "wire" }
    if last then edges[#edges + 1] = { last, id } end
    last = id
  end
  local before, times = {}, {}
  scene:measure("spread " .. name, function(s)
    for k, id in ipairs(list) do
      local x, v = s:position(id)[1], s:velocity(id)[1]
      if before[k] and before[k] > 0 and x <= 0 and not times[k] then times[k] = s.t - x / v end
      before[k] = x
    end
    return #times == #list and math.max(table.unpack(times)) - math.min(table.unpack(times)) or 0
  end, { unit = "s" })
  for _, id in ipairs(list) do beads[#beads + 1] = id end
  return list
end

scene:constraint("surface", { particles = wire(cycloid, "cycloid"), label = "cycloid",
  g = function(_, x, _, z) return z - a * (1 - math.cos(angle(x))) end,
  g_gradient = function(_, x) return -math.tan(angle(x) / 2), 0, 1 end, h = function(_, _, y) return y end })
scene:constraint("surface", { particles = wire(circle, "circle"), label = "circle", shape = "circle",
  position = { 0, 1, 4 * a }, axis = { 0, 1, 0 }, radius = 4 * a })
scene:force("gravity", { g = { 0, 0, -g }, only = beads })
scene:force("springs", { edges = edges, k = 1 })
scene:output("frames", { width = 1280, height = 640, color = "group", size = "mass", radius = 0.07, least = 1,
  from = { 0, -4.2, 1.3 }, look_at = { 0, 0.3, 0.55 }, ground_height = -0.05 })
return scene
