-- stiff_cloth.lua: the curtain of curtain.lua with any stiffness: the upper row is pinned, the cloth falls from the
-- horizontal and swings below. Every stiffness is k/1000 times the curtain's and every damping sqrt(k/1000) times: with
-- larger k the cloth stretches less and an explicit step shrinks with the root of k, but an implicit step need not. k:
-- 1e3 (strains in colour) to 1e8 N/m (white).
local N = param("N", 32, "particles along one side", { min = 3, max = 2048 })
local k = param("k", 1e5, "structural stiffness, N/m", { min = 0 })
local c = math.sqrt(k / 1000)

local scene = hooke.scene { duration = 1.5, fps = 60, integrator = "linear_bdf2" }

local cloth = scene:grid { nx = N, ny = N, width = 1, height = 1, mass = 0.15 }
local row = {}
for i = 1, N do row[i] = cloth:at(i, N) end
scene:pin(row)

scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("drag", { rate = 0.02 })
scene:force("springs", { edges = cloth:structural(), k = k, damping = 0.02 * c, label = "structural" })
scene:force("springs", { edges = cloth:shear(), k = 0.3 * k, damping = 0.01 * c, label = "shear" })
scene:force("springs", { edges = cloth:flexion(), k = 0.05 * k, damping = 0.005 * c, label = "flexion" })

scene:output("frames", { width = 960, height = 720, range = { -0.003, 0.003 } })
scene:measure("lowest", function(s)
  local z = 0
  for i = 1, N do z = math.min(z, s:position(cloth:at(i, 1))[3]) end
  return z
end, { unit = "m" })
scene:measure("stretch", function(s) return s:strain("structural") end)
return scene
