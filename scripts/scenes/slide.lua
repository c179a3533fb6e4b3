-- slide.lua: a sheet falls a centimetre onto a slope of 24 degrees and slides down. The contact is that of impulses after
-- each step, of a smooth force, of both, of Bridson's pipeline, of a plain penalty, or of a barrier (for bdf2), compared by
--   hooke bench slide.lua --integrators leapfrog --vary contact=corrector,force,both,zones,penalty
-- The sheet lands flat, so that rigid contact with Coulomb's friction has an exact solution. Forces hold the sheet some
-- of their reach above the slope, and slip below their smooth speed; that stays, however short the steps.
local contact = param("contact", "corrector", "corrector, force, both, zones, penalty or barrier")
local k = param("k", 1000, "stiffness of contact by force, N/m", { min = 0 })
local N, thickness, friction = 6, 0.004, 0.3

local scene = hooke.scene { duration = 0.5, fps = 50, integrator = "leapfrog" }

local sheet = scene:grid { nx = N, ny = N, width = 0.2, height = 0.2, mass = 0.02,
  origin = { 0, 0, 0.01 + thickness / 2 }, u = { 1, 0, 0 }, v = { 0, 1, 0 } }
scene:force("gravity", { g = { 4, 0, -8.96 }, only = sheet:ids() })
scene:force("springs", { edges = sheet:structural() .. sheet:shear(), k = 50, damping = 0.05 })

local floor = scene:mesh { vertices = { { -5, -5, 0 }, { 5, -5, 0 }, { 5, 5, 0 }, { -5, 5, 0 } },
  faces = { { 1, 2, 3 }, { 1, 3, 4 } }, mass = 1 }
scene:pin(floor:ids())
if contact == "penalty" then
  scene:force("penalty", { shape = "plane", radius = thickness / 2, friction = friction, k = k, damping = 5, slip = 0.01,
    only = sheet:ids() })
elseif contact == "barrier" then
  scene:force("barrier", { thickness = thickness, friction = friction, d_hat = thickness / 8 })
else
  local law = { thickness = thickness, friction = friction }
  if contact ~= "force" then
    scene:corrector(contact == "zones" and "impact_zones" or "contact", law)
  end
  if contact == "force" or contact == "both" then
    law.stiffness, law.damping, law.slip, law.reach = k, 5, 0.01, thickness / 8
    law.guard = contact == "force"
    scene:force("repulsion", law)
  end
end

local pull, weight, fall = 4, 8.96, 0.01
local landing = math.sqrt(2 * fall / weight)
scene:exact(function(t)
  local s, list = math.max(0, t - landing), {}
  local way = pull * t * t / 2 - friction * weight * (landing * s + s * s / 2)
  local z = thickness / 2 + math.max(0, fall - weight * t * t / 2)
  for j = 0, N - 1 do
    for i = 0, N - 1 do
      table.move({ 0.2 * i / (N - 1) + way, 0.2 * j / (N - 1), z }, 1, 3, #list + 1, list)
    end
  end
  return table.unpack(list)
end)
scene:measure("way", function(s) return s:position(sheet:at(1, 1))[1] end, { unit = "m" })
scene:output("table")
return scene
