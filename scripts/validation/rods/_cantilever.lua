-- Rods of length 1, stiffness EI = 1 and mass 1, of n inextensible segments, that bend by angle_springs or by rods. A
-- clamped one begins at x = 0 along x (its first segment lies in the wall); the error of the chain is of order 1/n^2.
local validation = require("validation")

local cantilever = {}

cantilever.forces = { "angle_springs", "rods" }
-- What hooke validate --plugin may replace, and the parameters given.
cantilever.replaceable = { angle_springs = { "edges", "EI", "rest" }, rods = { "edges", "EI", "rest" } }

local bend = {
  angle_springs = function(scene, s, curvature)
    scene:force("angle_springs", { edges = s:edges(), EI = 1, rest = not curvature and 0 or nil, curvature = curvature,
      normal = curvature and { 0, 0, 1 } })
  end,
  rods = function(scene, s, curvature)
    scene:force("rods", { edges = s:edges(), EI = 1, rest = "straight", curvature = curvature,
      GJ = curvature and 1, axis = curvature and { 0, 1, 0 } })
  end,
}

-- options: dt, duration, fps, integrator; clamped (true), curve (a straight line along x), curvature at rest (0). Returns
-- the scene and the strand.
function cantilever.rod(n, force, options)
  local clamped = options.clamped ~= false
  local scene = hooke.scene { duration = options.duration, fps = options.fps or 1 / options.dt, dt = options.dt,
    integrator = options.integrator }
  local s = scene:strand { n = n + (clamped and 2 or 1), curve = options.curve or { { 0, 0, 0 }, { 1, 0, 0 } },
    clamped = clamped, radius = 1, mass = 1 }
  bend[force](scene, s, options.curvature)
  scene:constraint("bars", { edges = s:edges() })
  return scene, s
end

-- Particle k of the n + 1 of the bending part, from 0.
function cantilever.at(s, n, k) return s:at(#s:ids() - n + k) end

-- At rest under its forces: steps of backward Euler as long as half the first period damp all there is within some twenty;
-- with much longer ones it hangs on rounding whether Newton's iteration comes through from a straight start. load(scene,
-- s, tip) adds the forces. Returns the state and the strand.
function cantilever.equilibrium(n, force, load, options)
  local h, most = options and options.dt or 1, 100
  local all = { dt = h, duration = most * h, integrator = { "backward_euler", tolerance = 1e-11 } }
  for key, value in pairs(options or {}) do all[key] = value end
  local scene, s = cantilever.rod(n, force, all)
  if load then load(scene, s, cantilever.at(s, n, n)) end
  return validation.rest(scene, h, 1e-11, most * h):state(), s
end

-- Tip angle below the x axis (that of the last segment: without a moment at the tip it is constant there to order 1/n^2),
-- and the tip's way down and back.
function cantilever.tip(state, s, n)
  local a, b = state:position(cantilever.at(s, n, n - 1)), state:position(cantilever.at(s, n, n))
  return math.atan(a[2] - b[2], b[1] - a[1]), -b[2], 1 - b[1]
end

-- P at the tip, and w a length, downwards. The tip's particle has the mass 1/(2 n).
function cantilever.pull(P, n)
  return function(scene, _, tip) scene:force("gravity", { g = { 0, -2 * n * P, 0 }, only = { tip }, label = "pull" }) end
end

function cantilever.weight(w)
  return function(scene) scene:force("gravity", { g = { 0, -w, 0 } }) end
end

-- The orders of the terms of the error: after the second the fourth, but p.next.
local function orders_of(order, next)
  return order.space and { space = order.space, within = order.within, space_next = next or 4 } or order
end

-- For every force (or those of p.with) the quantities of `list`, { name, reference }; solve_one(n, force) returns their
-- values.
function cantilever.problem(p, list, source, solve_one)
  local forces = p.with or cantilever.forces
  local next = p.next
  p.quantities, p.with, p.next = {}, nil, nil
  for _, force in ipairs(forces) do
    for _, q in ipairs(list) do
      p.quantities[#p.quantities + 1] = { name = ("%s, %s"):format(q[1], force), reference = q[2], source = source,
        unit = q.unit, tolerance = q.tolerance, why = q.why, order = p.order and orders_of(p.order, next and next[force]) }
    end
  end
  p.forces = cantilever.replaceable
  p.space_label = p.space_label or "1/n, segments"
  p.solve = function(at)
    local all = {}
    for _, force in ipairs(forces) do
      for _, value in ipairs { solve_one(at.n, force, at) } do all[#all + 1] = value end
    end
    return all
  end
  return validation.problem(p)
end

-- The elastica under a load at the tip, P L^2/EI, or its own weight, w L^3/EI; `with`: forces, all by default. After
-- the extrapolation of order 2 what is left of rods falls by 7.9 a level, of angle springs by 16.
function cantilever.elastica(title, load, angle, down, back, tolerance, with)
  return cantilever.problem({
    title = title,
    with = with,
    space = { 16, 32, 64 },
    order = { space = 2 },
    tolerance = tolerance,
    next = { rods = 3 },
    why = "what is left after the extrapolation of errors of orders 2 and 4, of rods 2 and 3; digits of the reference",
    noise = 1e-10,
    quick = { space = { 4, 8, 16 }, tolerance = 1e-3 },
  }, { { "tip angle", angle, unit = "rad" }, { "way down/L", down }, { "way back/L", back } },
    "elastica, integrated to 113 bits", function(n, force)
      local state, s = cantilever.equilibrium(n, force, load(n))
      return cantilever.tip(state, s, n)
    end)
end

-- The load at which a straight rod buckles. A small force across it bends it by d = d_0/(1 - load/critical), so 1/d
-- vanishes at the critical load: the parabola through three loads below it has its zero there, but for 1e-7 or so of its own
-- and the squares of d. press(scene, n, tip, load) adds the load.
function cantilever.buckling(p, name, critical, source, press)
  local side, shares = 1e-5, { 0.94, 0.96, 0.98 }
  local pinned = p.pinned
  p.pinned = nil
  p.space = { 16, 32, 64 }
  p.order = { space = 2 }
  p.noise = 1e-6
  p.why = "that parabola, and errors of order 4"
  return cantilever.problem(p, { { name, critical } }, source, function(n, force)
    local x, y = {}, {}
    for k, share in ipairs(shares) do
      x[k] = share * critical * (1 - 0.3 / n ^ 2)
      local pushed
      local state = cantilever.equilibrium(n, force, function(scene, s, tip)
        pushed = pinned and cantilever.at(s, n, n // 2) or tip
        if pinned then
          scene:pin { cantilever.at(s, n, 0) }
          scene:pin({ tip }, { axes = { 1, 0, 0 } })
        end
        press(scene, n, tip, x[k])
        scene:force("gravity", { g = { 0, side * n, 0 }, only = { pushed }, label = "side" })
      end, { clamped = not pinned, dt = 10 }) -- near its critical load a rod is soft and slow, and bends little here
      y[k] = 1 / state:position(pushed)[2]
    end
    return cantilever.zero_of_parabola(x, y)
  end)
end

-- The zero of the parabola through three points that is nearest to that of the line through the first two.
function cantilever.zero_of_parabola(x, y)
  local a = (y[2] - y[1]) / (x[2] - x[1])
  local b = ((y[3] - y[2]) / (x[3] - x[2]) - a) / (x[3] - x[1])
  local zero = x[1] - y[1] / a
  for _ = 1, 20 do
    local f = y[1] + (zero - x[1]) * (a + b * (zero - x[2]))
    zero = zero - f / (a + b * (2 * zero - x[1] - x[2]))
  end
  return zero
end

return cantilever
