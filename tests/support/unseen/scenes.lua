-- Small scenes on which `hooke auto` has never been tuned: { name, n particles, duration, fps, lines of script }. Several
-- keep what is hard for late: a collision, a passage, a pulse, a rope that comes taut.
return {
  { "drum", n = 16, duration = 1, fps = 60, [[
    local cloth = scene:grid { nx = 4, ny = 4, width = 1, height = 1, mass = 0.2 }
    scene:pin { 1, 4, 13, 16 }
    scene:force("membrane", { triangles = cloth:triangles(), stiffness = 40, shear = 12, damping = 0.02 })
    scene:force("gravity", { g = { 0, 0, -9.81 } })]] },
  { "figure_eight", n = 3, duration = 12, fps = 20, [[
    local x, y, u, v = 0.97000436, -0.24308753, -0.93240737, -0.86473146
    scene:particle { position = { x, y, 0 }, velocity = { -u / 2, -v / 2, 0 }, mass = 1 }
    scene:particle { position = { -x, -y, 0 }, velocity = { -u / 2, -v / 2, 0 }, mass = 1 }
    scene:particle { position = { 0, 0, 0 }, velocity = { u, v, 0 }, mass = 1 }
    scene:force("nbody", { G = 1 })]] },
  { "late_collision", n = 4, duration = 2, fps = 60, [[
    for i = 1, 4 do
      scene:particle { position = { i - 1, 0, 0 }, velocity = { i == 1 and 2 or 0, 0, 0 }, mass = 1 }
    end
    scene:force("soft_spheres", { radius = 0.2, stiffness = 2e4, restitution = 0.9, friction = 0.2 })]] },
  { "elastic_pendulum", n = 2, duration = 8, fps = 30, [[
    scene:particle { position = { 0, 0, 0 }, mass = 1 }
    scene:particle { position = { 0.9, 0, -0.5 }, mass = 0.7 }
    scene:pin { 1 }
    scene:force("gravity", { g = { 0, 0, -9.81 } })
    scene:force("springs", { edges = { { 1, 2 } }, k = 60, rest = 1 })]] },
  { "chain", n = 12, duration = 2, fps = 50, [[
    for i = 1, 12 do scene:particle { position = { 0.1 * i, 0, 0 }, mass = 0.02 } end
    local edges = {}
    for i = 1, 11 do edges[i] = { i, i + 1 } end
    scene:pin { 1 }
    scene:force("gravity", { g = { 0, 0, -9.81 } })
    scene:force("springs", { edges = edges, k = 300, damping = 0.05 })
    scene:force("drag", { rate = 0.5 })]] },
  { "two_bars", n = 3, duration = 1.5, fps = 60, [[
    for i = 1, 3 do scene:particle { position = { i - 1, 0, 0 }, mass = 4 - i } end
    scene:pin { 1 }
    scene:force("gravity", { g = { 0, 0, -9.81 } })
    scene:constraint("bars", { edges = { { 1, 2 }, { 2, 3 } } })]] },
  { "gyration", n = 1, duration = 3, fps = 40, [[
    scene:particle { position = { 0, 0, 0 }, velocity = { 1, 0, 0.2 }, mass = 1 }
    scene:force("magnetic", { B = { 0, 0, 1 }, ratio = 30 })
    scene:force("gravity", { g = { 0, 2, 0 } })]] },
  { "cluster", n = 6, duration = 3, fps = 50, [[
    local at = { { 0, 0, 0 }, { 1.2, 0, 0 }, { 0, 1.25, 0 }, { 1.1, 1.1, 0.3 }, { 0.5, 0.5, 1.1 }, { 2.4, 0.4, 0.2 } }
    for i = 1, 6 do scene:particle { position = at[i], mass = 1 } end
    scene:force("lennard_jones", { epsilon = 1, sigma = 1 })
    scene:force("drag", { rate = 0.3 })]] },
  { "rope", n = 2, duration = 1.2, fps = 60, [[
    scene:particle { position = { 0, 0, 0 }, mass = 1 }
    scene:particle { position = { 0.2, 0, -0.1 }, mass = 2 }
    scene:pin { 1 }
    scene:force("gravity", { g = { 0, 0, -9.81 } })
    scene:force("ropes", { edges = { { 1, 2 } }, rest = 1.5, k = 4000, damping = 20 })]] },
  { "parametric", n = 1, duration = 6, fps = 40, [[
    scene:particle { position = { 0.2, 0, 0 }, mass = 1 }
    scene:force("central", { strength = function(t) return 100 * (1 + 0.3 * math.sin(20 * t)) end, power = 1 })
    scene:force("drag", { rate = 0.4 })]] },
  { "comet", n = 1, duration = 5, fps = 24, [[
    scene:particle { position = { 1.8, 0, 0 }, velocity = { 0, 2, 0 }, mass = 1 }
    scene:force("central", { strength = 30, power = -2 })]] },
  { "net_in_wind", n = 25, duration = 0.8, fps = 60, [[
    local net = scene:grid { nx = 5, ny = 5, width = 1, height = 1, mass = 0.1 }
    scene:pin { 1, 5 }
    scene:force("springs", { edges = net:edges(), k = 200, damping = 0.01 })
    scene:force("wind", { on = "particles", rate = 2, velocity = function(t) return { 3 * math.sin(2 * t), 1, 0 } end })
    scene:force("gravity", { g = { 0, 0, -9.81 } })]] },
  { "bent_beam", n = 8, duration = 0.5, fps = 100, [[
    local edges = {}
    for i = 1, 8 do scene:particle { position = { 0.1 * i, 0, 0 }, mass = 0.01 } end
    for i = 1, 7 do edges[i] = { i, i + 1 } end
    scene:pin { 1, 2 }
    scene:force("springs", { edges = edges, k = 500, damping = 0.1 })
    scene:force("angle_springs", { edges = edges, EI = 0.02, retardation = 1e-2 })
    scene:force("gravity", { g = { 0, 0, -9.81 } })]] },
  { "stiff_and_soft", n = 3, duration = 1, fps = 60, [[
    for i = 1, 3 do scene:particle { position = { 0.5 * i + (i == 3 and 0.05 or 0), 0, 0 }, mass = i == 2 and 0.01 or 1 } end
    scene:pin { 1 }
    scene:force("springs", { edges = { { 1, 2 } }, k = 2e4, rest = 0.5, damping = 3 })
    scene:force("springs", { edges = { { 2, 3 } }, k = 30, rest = 0.5 })]] },
  { "rod", n = 9, duration = 0.3, fps = 100, [[
    local edges = {}
    for i = 1, 9 do scene:particle { position = { 0.05 * i, 0, 0 }, mass = 0.004 } end
    for i = 1, 8 do edges[i] = { i, i + 1 } end
    scene:pin { 1, 2 }
    scene:force("springs", { edges = edges, k = 2000, damping = 0.2 })
    scene:force("rods", { edges = edges, EI = 0.002, rest = "straight" })
    scene:force("gravity", { g = { 0, 0, -9.81 } })]] },
  { "late_flyby", n = 1, duration = 2, fps = 30, [[
    scene:particle { position = { -3, 0.02, 0 }, velocity = { 2, 0, 0 }, mass = 1 }
    scene:force("central", { strength = 0.05, power = -2, softening = 0.05 })]] },
  { "late_pulse", n = 2, duration = 2, fps = 50, [[
    scene:particle { position = { 0, 0, 0 }, mass = 1 }
    scene:particle { position = { 0, 0, -1 }, mass = 0.5 }
    scene:pin { 1 }
    scene:force("springs", { edges = { { 1, 2 } }, k = 200, rest = 1 })
    scene:force("gravity", { g = function(t) return { t > 1.6 and t < 1.63 and 200 or 0, 0, -9.81 } end })]] },
  { "five_bodies", n = 5, duration = 3, fps = 30, [[
    for i = 1, 5 do
      local a = 2 * math.pi * i / 5
      scene:particle { position = { math.cos(a) * (1 + 0.1 * i), math.sin(a), 0 },
        velocity = { -0.9 * math.sin(a), 0.9 * math.cos(a), 0.1 * i }, mass = 0.2 + 0.1 * i }
    end
    scene:force("nbody", { G = 1, softening = 0.1 })]] },
  { "relaxing", n = 3, duration = 3, fps = 40, [[
    for i = 1, 3 do scene:particle { position = { i, 0, 0.1 * i * i }, mass = 0.5 } end
    scene:pin { 1 }
    scene:force("gravity", { g = { 0, 0, -9.81 } })
    scene:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = 200 })
    scene:force("maxwell_springs", { edges = { { 1, 3 } }, k_m = 50, tau = 0.3, k = 0 })]] },
  { "soft_floor", n = 1, duration = 2, fps = 60, [[
    scene:particle { position = { 0, 0, 1 }, velocity = { 0.5, 0, 0 }, mass = 1 }
    scene:force("gravity", { g = { 0, 0, -9.81 } })
    scene:force("penalty", { k = 5e3 })]] },
}
