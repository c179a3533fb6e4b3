-- ice_chain.lua: a weight hangs on a chain of ice links, of which a burner warms the one in the middle. Springs of ice are
-- as stiff as they are frozen, so the chain grows longer while the link melts, and fails when it has molten (Terzopoulos,
-- Platt, Fleischer 1989). The heat goes along the chain, too, and every link gets some of the air's.
local heat = require("heat")
local power = param("power", 500, "of the burner, W", { min = 0 })
local n, link, mass = 13, 0.04, 0.002 -- particles, m, kg of each
local stiffness = 5e3                 -- N/m, of a link
local middle = (n + 1) // 2

local scene = hooke.scene { duration = 2.5, fps = 30, integrator = "leapfrog" }
scene:channel("enthalpy", { initial = heat.enthalpy("ice", 270) })
scene:channel("given", { initial = 0 })
local ids, edges = {}, {}
for k = 1, n do
  ids[k] = scene:particle { position = { 0, 0, -k * link }, mass = k == n and 0.5 or mass, group = k == n and "weight" or "ice" }
  if k > 1 then edges[k - 1] = { ids[k - 1], ids[k] } end
end
scene:pin({ ids[1] })
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("drag", { d = 0.05 })
local ice = { material = "ice", channel = "enthalpy", account = "given" }
local function with(more)
  for name, value in pairs(ice) do more[name] = value end
  return more
end
scene:force("conduction", with { edges = edges, section = 3e-4 })
scene:force("heating", with { area = 2e-3, convection = 20, surroundings = 293, label = "air" })
scene:force("heating", with { particles = { ids[middle] }, power = power, label = "burner" })
scene:force("melting_springs", { edges = edges, k = stiffness, channel = "enthalpy", softens = 0,
  range = heat.enthalpy("ice", 273.15, 1) / 2 })

local broke -- s
scene:measure("broke", function(s)
  local p, q = s:position(ids[middle]), s:position(ids[middle + 1])
  if not broke and p[3] - q[3] > 3 * link then broke = s.t end
  return broke or 0
end)
heat.measure_balance(scene, ids)
scene:output("frames", { color = "enthalpy", range = { -7000, 330e3 }, unit = "J/kg", map = "viridis", radius = 0.017,
  from = { 0.1, -1.5, -0.35 }, look_at = { 0, 0, -0.35 }, ground = false, fov = 32 })
return scene
