-- wind_cloth.lua: a flag on its mast in a gusty wind lifts and flutters, and waves run along it. Each triangle feels
-- drag and lift by its angle to the relative wind. These forces rotate with the cloth, and have no energy and an
-- unsymmetric Jacobian, so implicit methods need a solver for unsymmetric matrices here.
local N = param("N", 16, "particles along the height", { min = 3, max = 512 })
local k = param("k", 2e3, "structural stiffness, N/m", { min = 1 })
local speed = param("speed", 6, "mean wind, m/s", { min = 0 })

local scene = hooke.scene { duration = 3, fps = 60, integrator = "tr_bdf2", tol = 1e-2 }

local M = 3 * (N - 1) // 2 + 1 -- the flag is 1.5 m x 1 m of 150 g/m^2
local flag = scene:grid { nx = M, ny = N, width = 1.5, height = 1, mass = 0.225, u = { 1, 0, 0 }, v = { 0, 0, 1 } }
local mast = {}
for j = 1, N do mast[j] = flag:at(1, j) end
scene:pin(mast)

local c = 0.5 * math.sqrt(k / 1000)
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("springs", { edges = flag:structural(), k = k, damping = c, label = "structural" })
scene:force("springs", { edges = flag:shear(), k = 0.3 * k, damping = c / 2, label = "shear" })
scene:force("springs", { edges = flag:flexion(), k = 0.02 * k, damping = c / 4, label = "flexion" })
scene:force("wind", { friction = 0.02, velocity = function(t)
  local gust = 1 + 0.25 * math.sin(2.1 * t) + 0.15 * math.sin(5.3 * t)
  local turn = 0.5 * math.sin(3.1 * t) + 0.35 * math.sin(7.7 * t)
  return speed * gust * math.cos(turn), speed * gust * math.sin(turn), 0
end })

scene:measure("tip x", function(s) return s:position(flag:at(M, 1))[1] end, { unit = "m" })
scene:measure("tip y", function(s) return s:position(flag:at(M, 1))[2] end, { unit = "m" })
scene:measure("tip z", function(s) return s:position(flag:at(M, 1))[3] end, { unit = "m" })
scene:measure("stretch", function(s) return s:strain("structural") end)
scene:output("frames", { width = 1280, height = 720, color = "none",
  from = { 1.5, -3.3, 1.05 }, look_at = { 0.72, 0, 0.42 }, ground_height = -0.4 })
return scene
