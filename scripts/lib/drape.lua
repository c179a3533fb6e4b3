-- drape: what the scenes of contact share: sheets of cloth by the numbers of their material, and the contact of all
-- surfaces of a scene, by impulses after each step of an explicit method or by a barrier for an implicit one. To compare
-- with there are a repulsion without impulses (force) and the pipeline of Bridson, Fedkiw and Anderson (zones).
local drape = {}
local contacts = { impulses = true, barrier = true, force = true, zones = true }

-- hooke.scene with a method that suits the contact.
function drape.scene(contact, t)
  assert(contacts[contact], "contact: impulses, barrier, force or zones, not " .. contact)
  t.fps = t.fps or 60
  t.integrator = contact == "barrier" and "bdf2" or "leapfrog"
  t.dt = contact == "barrier" and 1 / 120 or t.dt
  local scene = hooke.scene(t)
  scene:force("gravity", { g = { 0, 0, -9.81 } })
  return scene
end

-- A grid of a material: density (kg/m^2), stiffness (N/m), rigidity of bending (N m).
function drape.sheet(scene, t)
  local cloth = scene:grid { nx = t.nx, ny = t.ny, width = t.width, height = t.height, density = t.density or 0.2,
    alternating = true, origin = t.origin, u = t.u, v = t.v, group = t.group }
  local name = t.group or "cloth"
  local springs = scene:membrane(cloth, { stiffness = t.stiffness or 100, nu = 1 / 3, damping = t.damping or 0.02 })
  springs.label = "stretch of " .. name
  scene:force("springs", springs)
  scene:force("hinges", { triangles = cloth:triangles(), rigidity = t.rigidity or 2e-5, damping = t.bend_damping or 1e-6,
    label = "bending of " .. name })
  return cloth
end

-- Keeps all surfaces of the scene apart by `thickness` (m), strands by twice `radius`, with Coulomb's friction.
function drape.contact(scene, contact, t)
  if contact == "barrier" then
    -- The barrier ends at d_hat beyond the thickness: together they are as thick as the cloth.
    scene:force("barrier", { thickness = t.thickness and t.thickness / 2, d_hat = (t.thickness or 2 * t.radius) / 2,
      radius = t.radius and t.radius / 2, friction = t.friction, leave = t.leave })
  elseif contact == "force" then
    scene:force("repulsion", { thickness = t.thickness, radius = t.radius, friction = t.friction, leave = t.leave,
      stiffness = t.stiffness or 200, damping = 2 })
  else
    scene:corrector(contact == "zones" and "impact_zones" or "contact",
      { thickness = t.thickness, radius = t.radius, friction = t.friction, leave = t.leave })
  end
end

-- The lowest height of some particles, for scene:measure.
function drape.lowest(ids)
  return function(s)
    local z = math.huge
    for _, i in ipairs(ids) do z = math.min(z, s:position(i)[3]) end
    return z
  end
end

return drape
