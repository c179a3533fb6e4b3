-- The ways to keep surfaces apart, each with a method that suits it. methods.add(name, scene, p) adds the contact of the
-- parameters friction, radius (m, of lone particles), restitution and the speed of impacts, m/s, that it is for, and
-- where it is to be known best stiffness, N/m, of a repulsion.
local methods = { names = { "impulses", "repulsion", "barrier" } }

methods.integrator = { impulses = "leapfrog", zones = "leapfrog", repulsion = "leapfrog", barrier = "bdf2" }
methods.gap = { impulses = 0, repulsion = 5e-4, barrier = 1e-3 } -- m, at which surfaces do not push each other yet
-- The repulsion's friction is mu N v/sqrt(v^2 + s^2), 1 % less than Coulomb's still at 7 s: s is 1e-4 m/s here. It is a drag
-- below s, for which explicit steps are at most some s/(mu g) long.
local slip = 1e-4
methods.part = { impulses = 1, repulsion = 1 / 64, barrier = 1 } -- of a step

local add = {
  impulses = function(scene, p)
    scene:corrector("contact", { friction = p.friction, restitution = p.restitution, radius = p.radius, leave = p.leave })
  end,
  -- Bridson, Fedkiw and Anderson 2002: with no sweep of impulses, what collides becomes rigid.
  zones = function(scene, p)
    scene:corrector("impact_zones", { friction = p.friction, restitution = p.restitution, radius = p.radius, leave = p.leave,
      sweeps = p.sweeps })
  end,
  repulsion = function(scene, p)
    scene:force("repulsion", { friction = p.friction, radius = p.radius, stiffness = p.stiffness or 1e4, leave = p.leave,
      slip = slip, damping = p.restitution and 1.5 * (1 - p.restitution) / p.speed or 5 })
  end,
  barrier = function(scene, p)
    scene:force("barrier", { friction = p.friction, radius = p.radius, leave = p.leave })
  end,
}

function methods.add(name, scene, p) add[name](scene, p) end

return methods
