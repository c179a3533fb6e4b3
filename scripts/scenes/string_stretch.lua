-- string_stretch.lua: three strings with the same weights fall from the horizontal: a soft one of springs, one of stiff
-- springs, and one of rigid bars, which does not stretch at all. Springs trade stretch against the step: the stiff one
-- needs steps ten times as short as the soft one; bars need none shorter than the motion does. At rest a string of n
-- segments, of stiffness EA and weight W hangs W L (1 + 1/n)/(2 EA) longer: down=1 starts them hanging, to see that.
local n = param("n", 20, "segments of each", { min = 2 })
local EA = param("EA", 20, "stiffness of the soft string, N; the stiff one has 100 times that", { min = 1 })
local down = param("down", 0, "1: they start hanging down", { min = 0, max = 1 })
local drag = param("drag", 0.5, "damping, 1/s", { min = 0 })
local T = param("duration", 5, "s", { min = 0.1 })

local scene = hooke.scene { duration = T, fps = 60, integrator = "leapfrog" }
local length, weight, g = 1, 1, 9.81 -- m, N
for k, name in ipairs { "soft", "stiff", "bars" } do
  local s = scene:strand { n = n + 1, from = { 0, 0.4 * k, 0 }, length = length, mass = weight / g * (n + 1) / n,
    direction = down == 1 and { 0, 0, -1 } or { 1, 0, 0 }, group = name }
  scene:pin { s:at(1) }
  local edges = s:structural()
  if name == "bars" then scene:constraint("bars", { edges = edges })
  else scene:force("springs", { edges = edges, k = (name == "soft" and 1 or 100) * EA * n / length, label = name }) end
  scene:measure("length of " .. name, function(state)
    local sum, a = 0, state:position(s:at(1))
    for i = 2, n + 1 do
      local b = state:position(s:at(i))
      sum = sum + math.sqrt((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2 + (b[3] - a[3]) ^ 2)
      a = b
    end
    return sum
  end, { unit = "m" })
end
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("drag", { rate = drag })
scene:output("frames", { width = 960, height = 720, color = "group", radius = 0.018 })
return scene
