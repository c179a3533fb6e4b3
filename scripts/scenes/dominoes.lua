-- dominoes.lua: a row of dominoes, rigid bodies in contact with each other and with the floor. The first is pushed, each pushes
-- the next over and comes to lie on it. The measure `fallen` counts those that lean by more than half a radian, `energy of the row`
-- only falls, J.
local n = param("n", 8, "dominoes")
local T = param("duration", 1.2, "s", { min = 0.1 })
local gap = param("gap", 0.06, "m", { min = 0.01 })
local mu = param("friction", 0.3, "")

local scene = hooke.scene { duration = T, fps = 50, dt = 1 / 500, integrator = "leapfrog" }

local g, size, thickness = 9.81, { 0.02, 0.1, 0.2 }, 0.002
local row = {}
for k = 1, n do
  row[k] = scene:rigid { shape = "box", size = size, density = 700, position = { (size[1] + gap) * (k - 1), 0, (size[3] + thickness) / 2 },
    spin = { 0, k == 1 and 4 or 0, 0 } }
  row[k]:surface()
end
scene:body { shape = "box", size = { 4, 1, 0.1 }, position = { (size[1] + gap) * n / 2, 0, -0.05 } }
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("contact", { thickness = thickness, friction = mu })

scene:measure("fallen", function(s)
  local count = 0
  for k = 1, n do
    local _, R = row[k]:attitude(s)
    if R[3][3] < math.cos(0.5) then count = count + 1 end
  end
  return count
end)
scene:measure("energy of the row", function(s)
  local E = 0
  for k = 1, n do E = E + row[k]:energy(s) + row[k].mass * g * row[k]:position(s)[3] end
  return E
end, { unit = "J" })
scene:output("frames", { width = 1280, height = 540, legend = false, from = { 0.3 * (size[1] + gap) * n, -1.1, 0.5 },
  look_at = { 0.5 * (size[1] + gap) * n, 0, 0.06 } })
return scene
