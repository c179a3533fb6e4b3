--[[
what: a weight of 10 kg rests on a sheet of a gram, which rests on a plate: ten thousand times the mass, and no room to give
right: closed form: nothing moves
must: none
]]
-- The bound: a tenth of the sheet's thickness.
local h, r = 1e-3, 5e-4
local scene = hooke.scene { duration = 0.1, fps = 100, accuracy = 1e-4 }
local place = {}
for _, p in ipairs { { -0.1, -0.1 }, { 0.1, -0.1 }, { 0, 0.15 } } do place[#place + 1] = { p[1], p[2], h / 2 } end
local sheet = scene:mesh { vertices = place, faces = { { 1, 2, 3 } }, mass = 1e-3 }
scene:particle { position = { 0.01, 0.02, h + r }, mass = 10 }
scene:body { shape = "plane", size = 1 }
scene:force("springs", { edges = sheet:edges(), k = 10, damping = 0.01 })
scene:force("gravity")
scene:corrector("contact", { thickness = h, radius = r })
scene:exact(function()
  local all = {}
  for k = 1, 3 do for c = 1, 3 do all[#all + 1] = place[k][c] end end
  all[10], all[11], all[12] = 0.01, 0.02, h + r
  return all
end)
return scene
