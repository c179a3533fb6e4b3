-- Andrews' squeezer: seven plane bodies in three loops on common hinges, a spring, and a motor of constant torque, for 0.03 s, in
-- which the crank turns two and a half times. As bodies in space on hinges two thirds of what its loops keep follows from the
-- rest, and is found. Numbers, start and end of Mazzia and Magherini, Test Set for IVP Solvers (2008), II-10, after Schiehlen,
-- Multibody Systems Handbook (1990), and Hairer and Wanner, Solving ODEs II, VII.7; the end by PSIDE at 1e-14.
local validation = require("validation")

local mass = { 0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498 } -- kg
local inertia = { 2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5 } -- kg m^2
local xa, ya, xb, yb, xc, yc = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072 -- m
local d, da, e, ea, rr, ra = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092
local sa, sb, sc, sd = 0.01874, 0.01043, 0.018, 0.02
local ta, tb, u, ua, ub, zf, zt, fa = 0.02308, 0.00916, 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421
local stiffness, rest, torque = 4530, 0.07785, 0.033 -- N/m, m, N m

-- The start: beta, Theta, gamma, Phi, delta, Omega, epsilon, rad.
local start = { -0.0617138900142764496358948458001, 0, 0.455279819163070380255912382449, 0.222668390165885884674473185609,
  0.487364979543842550225598953530, -0.222668390165885884674473185609, 1.23054744454982119249735015568 }
local final = { 15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948, 0.5244099658805304,
  0.5347301163226948, 1.048080741042263 }

-- The turn of each body, rad, by the angles.
local function turns(q) return { q[1], q[1] + q[2], q[3], q[4] + q[5], q[5], q[6] + q[7], q[7] } end

-- Places of the start: of a + r along the direction at the angle, + s across it, to the left.
local function place(a, angle, r, s)
  local c, n = math.cos(angle), math.sin(angle)
  return { a[1] + r * c - s * n, a[2] + r * n + s * c, 0 }
end

local function build(scene)
  local t = turns(start)
  local A, B, O = { xa, ya }, { xb, yb }, { 0, 0 }
  local crank = place(O, t[1], rr, 0)
  local middle = place(crank, t[2], -d, 0)
  local elbow, knee = place(A, t[5], zt, 0), place(A, t[7], 0, -u)
  local center = { place(O, t[1], ra, 0), place(crank, t[2], -da, 0), place(B, t[3], sb, -sa), place(elbow, t[4], 0, -(e - ea)),
    place(A, t[5], ta, tb), place(knee, t[6], zf - fa, 0), place(A, t[7], -ub, -ua) }
  local body = {}
  for k = 1, 7 do
    local I = inertia[k]
    body[k] = scene:rigid { mass = mass[k], inertia = { I, I, I }, position = center[k], orientation = { 0, 0, t[k] } }
  end
  local function hinge(a, b, at)
    return scene:joint { kind = "hinge", a = body[a], b = body[b], at = { at[1], at[2], 0 }, axis = { 0, 0, 1 } }
  end
  local axle = hinge(1, nil, O)
  hinge(2, 1, crank)
  hinge(3, nil, B)
  hinge(3, 2, middle)
  hinge(4, 2, middle)
  hinge(6, 2, middle)
  hinge(5, nil, A)
  hinge(7, nil, A)
  hinge(4, 5, elbow)
  hinge(6, 7, knee)
  local held = scene:particle { position = { xc, yc, 0 }, mass = 1 }
  scene:pin { held }
  scene:force("springs", { edges = { { held, body[3]:point { -sb + sd, sa - sc, 0 } } }, k = stiffness, rest = rest })
  scene:force("joint_drives", { points = { axle:frame() }, damping = 1, speed = 1e6, most = torque })
  return body
end

local quantities = {}
for k, name in ipairs { "crank", "body 2", "body 3", "body 4", "body 5", "body 6", "body 7" } do
  quantities[k] = { name = "x axis of " .. name, reference = math.cos(turns(final)[k]), scale = 1,
    source = "Test Set for IVP Solvers, II-10" }
end

return validation.problem {
  title = "Andrews' squeezer by rk4",
  quantities = quantities,
  together = true,
  time = { 4e-5, 2e-5, 1e-5 },
  order = { time = 4, within = 0.8 },
  tolerance = 1e-8,
  why = "errors of order 5 are as large as those of order 4, which are left",
  quick = { time = { 1e-4, 5e-5, 2.5e-5 }, tolerance = 1e-2 },
  solve = function(at)
    local scene = hooke.scene { duration = 0.03, fps = validation.fps(at.h), dt = at.h, integrator = "rk4" }
    local body, now = build(scene), {}
    local state = scene:run():state()
    for k = 1, 7 do now[k] = select(2, body[k]:attitude(state))[1][1] end
    return now
  end,
}
