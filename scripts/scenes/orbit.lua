-- orbit.lua: a planet on a Kepler ellipse of eccentricity 0.6 around a sun at the origin; one turn takes 2 pi s. The
-- energy error of leapfrog stays bounded, rk4 loses energy slowly, and with euler the planet spirals outwards.
local e = param("e", 0.6, "eccentricity", { min = 0, max = 0.95 })
local turns = param("turns", 3, "orbits to follow", { min = 0.1 })

local scene = hooke.scene { duration = turns * 2 * math.pi, fps = 30, integrator = "leapfrog", dt = 1 / 600 }

local p = scene:particle { position = { 1 - e, 0, 0 }, velocity = { 0, math.sqrt((1 + e) / (1 - e)), 0 }, mass = 1 }
scene:force("central", { center = { 0, 0, 0 }, strength = 1, power = -2 })

scene:exact(function(t) -- Kepler's equation E - e sin E = t by Newton's method
  local E = t + e * math.sin(t)
  for _ = 1, 50 do E = E - (E - e * math.sin(E) - t) / (1 - e * math.cos(E)) end
  return math.cos(E) - e, math.sqrt(1 - e * e) * math.sin(E), 0
end)
scene:measure("energy", function(s) return s:energy() end, { unit = "J" })
scene:measure("distance", function(s)
  local x = s:position(p)
  return math.sqrt(x[1] ^ 2 + x[2] ^ 2)
end, { unit = "m" })
scene:output("table")
return scene
