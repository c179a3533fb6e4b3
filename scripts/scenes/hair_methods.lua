-- hair_methods.lua: the same straight hair, 0.04 mm thick and of 4 GPa, falls from where it grows by three methods:
-- springs in implicit steps, of which a frame takes one or more, bars in explicit steps, which the stiffness of bending
-- keeps below 1.2 ms, and XPBD in small steps. Each has a level; from one to the next its steps are half as long.
-- scripts/sweeps/hair.lua draws speed against error. Springs stretch 3000 times as easily as the hair would.
local method = param("method", "implicit", "implicit, bars, xpbd")
local level = param("level", 0, "the higher, the more accurate and the slower", { min = 0, max = 12 })
local S = param("strands", 20, "of hair", { min = 1, max = 100000 })
local n = param("segments", 32, "of a strand", { min = 2, max = 1000 })

local dt = { implicit = 1 / 60, bars = 1 / 840, xpbd = 1 / 60 }
if not dt[method] then error("method: one of implicit, bars, xpbd") end
local h = dt[method] / (method == "xpbd" and 1 or 2 ^ level)
local scene = hooke.scene { duration = 1, fps = 60, dt = h }
if method == "implicit" then scene:integrator("bdf2", { tolerance = 1e-2, reuse = false })
elseif method == "xpbd" then scene:integrator("xpbd", { substeps = math.tointeger(10 * 2 ^ level) })
else scene:integrator("leapfrog") end

local hair = scene:hair { on = { radius = 0.09, cap = 1.3 }, strands = S, n = n + 1, length = 0.3, spread = 0.05, seed = 1,
  radius = 4e-5, E = 4e9, nu = 0.4, density = 1300 }
local edges = hair:edges()
if method == "bars" then scene:constraint("bars", { edges = edges })
else scene:force("springs", { edges = edges, k = hair.stiffness / 3000, label = "stretch" }) end
scene:force("angle_springs", { edges = edges, EI = hair.EI })
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("drag", { rate = 8 })
scene:measure("stretch", function(s) return method == "bars" and 0 or s:strain("stretch") end)
scene:output("frames", { width = 960, height = 720, color = "speed", particles = "off", spheres = { 0, 0, 0, 0.09 } })
return scene
