-- swing.lua: a rider pumps a swing from 0.2 rad to three times its energy by rising and sinking alone, and ends as far from the hook as it
-- hangs: up where the swing is fast, down where it turns, twice in a period. The least pumping that does it is found by
--   hooke optimise swing.lua
local scene = hooke.scene { duration = 12, fps = 20, integrator = "leapfrog", dt = 5e-3 }
local pump = scene:control("pump", { knots = 49, help = "by how much the rider rises, m", start = {
  -0.0037, -0.0574, -0.0625, -0.0144, 0.0525, 0.0729, 0.0236, -0.0408, -0.0674, -0.0381, 0.0282, 0.0742, 0.0483,
  -0.0181, -0.0635, -0.0558, 0.0008, 0.0633, 0.0667, 0.0083, -0.0509, -0.0657, -0.0254, 0.0425, 0.0748, 0.0350, -0.0310,
  -0.0666, -0.0471, 0.0157, 0.0705, 0.0577, -0.0058, -0.0584, -0.0616, -0.0122, 0.0543, 0.0722, 0.0219, -0.0416,
  -0.0679, -0.0394, 0.0251, 0.0704, 0.0530, 0.0080, -0.0100, 0.0039, 0.0004 } })
local k, length, angle, m, g = 2e4, 2.5, 0.2, 40, 9.81 -- N/m, m, rad, kg, m/s^2
local rider = scene:particle { position = { length * math.sin(angle), 0, -length * math.cos(angle) }, mass = m }
scene:force("gravity", {})
-- a stiff spring, damped along it, and the tension that changes its rest length by the rider's rise
local hook = scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:pin { hook }
scene:force("springs", { edges = { { hook, rider } }, k = k, damping = 200, rest = length })
scene:force("muscles", { edges = { { hook, rider } }, tension = function(t) return k * pump(t) end })
local function along(s) -- distance from the hook, and its rate
  local x, v = s:position(rider), s:velocity(rider)
  local r = math.sqrt(x[1] ^ 2 + x[2] ^ 2 + x[3] ^ 2)
  return r, (x[1] * v[1] + x[2] * v[2] + x[3] * v[3]) / r
end
scene:measure("distance", function(s) return (along(s)) end, { unit = "m" })
scene:measure("climb", function(s) return select(2, along(s)) end, { unit = "m/s" })
scene:measure("energy", function(s) -- of the swing by mass, from its lowest place at rest, J/kg
  local v, z = s:velocity(rider), s:position(rider)[3]
  return (v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2) / 2 + g * (z + length)
end, { unit = "J/kg" })
scene:goal { measure = "energy", value = 1 }
scene:goal { measure = "distance", value = 2.52 }
scene:goal { measure = "climb", value = 0 }
return scene
