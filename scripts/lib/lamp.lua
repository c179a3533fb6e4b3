-- A desk lamp of three links on a base, in the plane y = 0 (Witkin and Kass, Spacetime constraints, 1988): four muscles move it, and
-- springs hold its feet to the floor for given times.
--   local lamp = require("lamp").new(scene, { x = 0, z = 0, angle = 0 })   -- where its base stands, rad downhill along x
--   lamp:muscles(scene, 61, start)
local lamp = {}
lamp.__index = lamp

local links = { { "heel", -0.12, 0, 0.3, "base" }, { "toe", 0.12, 0, 0.3, "base" }, { "ankle", 0, 0.05, 0.3, "base" },
  { "knee", -0.2, 0.4, 0.15, "arm" }, { "elbow", 0.1, 0.65, 0.2, "arm" }, { "head", 0.25, 0.55, 0.4, "head" } } -- m, kg
local weight = 1.65 -- kg, of all

-- Its particles stand as links have them, turned by the angle about the middle of its base; in the plane, out of which muscles that push
-- would buckle it. The base's and the links' springs give 5 mm at most.
function lamp.new(scene, stand)
  local self = setmetatable({ ids = {}, masses = {}, angle = stand.angle or 0 }, lamp)
  local c, s = math.cos(self.angle), math.sin(self.angle)
  for k, link in ipairs(links) do
    local name, x, z, mass, group = table.unpack(link)
    self[name] = scene:particle { position = { (stand.x or 0) + c * x + s * z, 0, (stand.z or 0) - s * x + c * z }, mass = mass,
      group = group }
    self.ids[k], self.masses[k] = self[name], mass
  end
  scene:measure("climb", function(state) -- of the centre of mass, m/s
    local sum = 0
    for k, id in ipairs(self.ids) do sum = sum + self.masses[k] * state:velocity(id)[3] / weight end
    return sum
  end, { unit = "m/s" })
  scene:pin(self.ids, { normal = { 0, 1, 0 } })
  scene:force("gravity", {})
  scene:force("springs", { edges = { { self.heel, self.toe }, { self.heel, self.ankle }, { self.toe, self.ankle },
    { self.ankle, self.knee }, { self.knee, self.elbow }, { self.elbow, self.head } }, k = 2e4, damping = 20 })
  return self
end

-- A floor's hold, N/m: it fades before `leaves`, and grows after `lands`.
function lamp.hold(leaves, lands)
  local fades = 1 / 60 -- s
  return function(t)
    local s = math.min(math.max((t > (leaves + lands) / 2 and t - lands or leaves - t) / fades, 0), 1)
    return 2e4 * s * s * (3 - 2 * s)
  end
end

-- Each muscle is a spring and a tension, the control of its name with so many knots; start: by name, their values.
function lamp:muscles(scene, knots, start)
  local edges = { back = { self.heel, self.knee }, front = { self.toe, self.knee }, leg = { self.ankle, self.elbow },
    neck = { self.knee, self.head } }
  for _, name in ipairs { "back", "front", "leg", "neck" } do
    local pull = scene:control(name, { knots = knots, start = start and start[name], help = "N" })
    scene:force("springs", { edges = { edges[name] }, k = 1500, damping = 15 })
    scene:force("muscles", { edges = { edges[name] }, tension = function(t) return pull(t) end })
  end
end

return lamp
