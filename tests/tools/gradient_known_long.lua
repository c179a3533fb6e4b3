-- hooke gradient against closed forms, by every method that is differentiated and in both directions: scenes of one or two
-- particles whose derivatives are known; and against whole runs, of every kind of number that the forces of sheets, solids
-- and rods are made from, also those that change a shape at rest.
-- Under sanitizers the derivatives are the same there, and gradient.lua runs the same code.
if assert(os.getenv("HK_BUILD"), "HK_BUILD"):find("sanitize") then os.exit(77) end
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "gradient")
local write, read, gradient, refused = runs.write, runs.read, runs.run, runs.refused

local methods = { "leapfrog", "symplectic_euler", "rk4", "euler", "midpoint", "trapezoid" }

-- The rows of gradient.json by the parameters' names.
local function rows_of(scene)
  local rows = {}
  for part in read(("out/gradient/%s/gradient.json"):format(scene)):match('"parameters":(%b[])'):gmatch("%b{}") do
    local row = {}
    for key, value in part:gmatch('"([%w_]+)":([^,}]+)') do row[key] = tonumber(value) end
    rows[part:match('"name":"([^"]+)"')] = row
  end
  return rows
end

-- The derivative is off by what it says: the step's part, by the error of the extrapolation from half the step a half of
-- that more, and rounding.
local function check(scene, method, way, exact)
  local names = {}
  for name in pairs(exact) do names[#names + 1] = name end
  table.sort(names)
  local code, text = gradient(("%s.lua --of y --by %s --integrator %s --way %s"):format(scene, table.concat(names, ","), method, way))
  assert(code == 0 or code == 2 and not text:find("kink", 1, true), text)
  local rows = rows_of(scene)
  for name, slope in pairs(exact) do
    local row = rows[name]
    local off, said = math.abs(row.derivative - slope), 1.5 * row.by_steps + 10 * row.by_rounding + 1e-11 * math.abs(slope)
    assert(off <= said, ("%s, %s, %s: %s is %.12g, not %.12g: off by %.3g, said %.3g\n%s"):format(scene, method, way, name,
      row.derivative, slope, off, said, text))
  end
end

local function scene(name, head, body, exact)
  write(name .. ".lua", head .. "\n" .. body .. "\nreturn scene\n")
  for k, method in ipairs(methods) do check(name, method, k % 2 == 1 and "forwards" or "backwards", exact) end
  check(name, "leapfrog", "backwards", exact)
  check(name, "rk4", "forwards", exact)
end

local open = 'local scene = hooke.scene { duration = 1, fps = 10, integrator = "leapfrog", dt = 5e-4 }\n'

-- A central difference of a closed form: its error is below 1e-9 of what stands beside it here.
local function slopes(f, at)
  local exact = {}
  for name, value in pairs(at) do
    local function with(x)
      local p = {}
      for key, other in pairs(at) do p[key] = other end
      p[name] = x
      return f(p)
    end
    local h = 1e-3 * math.max(math.abs(value), 0.1)
    -- of the sixth order
    exact[name] = (45 * (with(value + h) - with(value - h)) - 9 * (with(value + 2 * h) - with(value - 2 * h))
      + with(value + 3 * h) - with(value - 3 * h)) / (60 * h)
  end
  return exact
end

local function params_of(at)
  local names, lines = {}, {}
  for name in pairs(at) do names[#names + 1] = name end
  table.sort(names)
  for k, name in ipairs(names) do lines[k] = ('local %s = param("%s", %.17g, "")'):format(name, name, at[name]) end
  return table.concat(lines, "\n")
end

local function known(name, at, body, f) scene(name, params_of(at), open .. body, slopes(f, at)) end

-- 1. A projectile with linear drag.
known("projectile", { g = 9.81, c = 0.7, speed = 8, angle = 0.8, m = 1.3 }, [[
local p = scene:particle { position = { 0, 0, 0 }, velocity = { speed * math.cos(angle), 0, speed * math.sin(angle) }, mass = m }
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("drag", { d = c })
scene:measure("y", function(s) return s:position(p)[3] + 0.3 * s:position(p)[1] end)]], function(p)
  local r = p.c / p.m
  local fade = (1 - math.exp(-r)) / r
  return p.speed * (math.sin(p.angle) + 0.3 * math.cos(p.angle)) * fade - p.g / r * (1 - fade)
end)

-- 2. A damped oscillator.
known("damped", { k = 30, c = 0.8, start = 0.2, m = 1.1 }, [[
local p, o = scene:particle { position = { start, 0, 0 }, mass = m }, scene:particle { position = { 0, 0, 0 } }
scene:pin { o }
scene:force("springs", { edges = { { o, p } }, k = k, rest = 0 })
scene:force("drag", { d = c })
scene:measure("y", function(s) return s:position(p)[1] end)]], function(p)
  local half = p.c / (2 * p.m)
  local w = math.sqrt(p.k / p.m - half ^ 2)
  return p.start * math.exp(-half) * (math.cos(w) + half / w * math.sin(w))
end)

-- 3. A chain of two springs hangs from a pin: both normal modes.
known("hanging", { k = 200, m = 0.5, g = 9.81 }, [[
local o = scene:particle { position = { 0, 0, 0 } }
local a = scene:particle { position = { 0, 0, -1 }, mass = m }
local b = scene:particle { position = { 0, 0, -2 }, mass = m }
scene:pin { o }
scene:force("springs", { edges = { { o, a }, { a, b } }, k = k, rest = 1 })
scene:force("gravity", { g = { 0, 0, -g } })
scene:measure("y", function(s) return s:position(b)[3] end)]], function(p)
  local y, q = -2, p.g * p.m / p.k -- still it sags by 2 q and 3 q
  for _, sign in ipairs { 1, -1 } do
    local square = (3 + sign * math.sqrt(5)) / 2
    local a, b = 1, 2 - square -- the mode
    local amount = (2 * q * a + 3 * q * b) / (a * a + b * b)
    y = y - amount * b * (1 - math.cos(math.sqrt(square * p.k / p.m)))
  end
  return y
end)

-- 4. Kepler's circle of radius r: where the particle is, by the strength and the speed (both are off the circle: of its
-- first variation).
known("kepler", { strength = 4 }, [[
local p = scene:particle { position = { 1, 0, 0 }, velocity = { 0, math.sqrt(strength), 0 } }
scene:force("central", { strength = strength, power = -2 })
scene:measure("y", function(s) return s:position(p)[1] + 2 * s:position(p)[2] end)]], function(p)
  local w = math.sqrt(p.strength)
  return math.cos(w) + 2 * math.sin(w)
end)

-- 5. A charge in a magnetic field, whose force turns with the velocity.
known("charge", { B = 3, speed = 2 }, [[
local p = scene:particle { position = { 0, 0, 0 }, velocity = { speed, 0, 0 }, mass = 1 }
scene:force("magnetic", { B = { 0, 0, B }, ratio = 1 })
scene:measure("y", function(s) return s:position(p)[2] + 0.5 * s:velocity(p)[1] end)]], function(p)
  return p.speed / p.B * (math.cos(p.B) - 1) + 0.5 * p.speed * math.cos(p.B)
end)

-- 6. A force that is a function of time: a driven oscillator.
known("driven", { w = 4, far = 0.3, turn = 2.5 }, [[
local p = scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:force("central", { strength = w * w, center = function(t) return far * math.sin(turn * t), 0, 0 end })
scene:measure("y", function(s) return s:position(p)[1] end)]], function(p)
  local a = p.far * p.w ^ 2 / (p.w ^ 2 - p.turn ^ 2)
  return a * (math.sin(p.turn) - p.turn / p.w * math.sin(p.w))
end)

-- 7. A spring whose rest length and place change, and a pin that moves on a path of its own.
known("pulled", { k = 25, rest = 0.7 }, [[
local o, p = scene:particle { position = { 0, 0, 0 } }, scene:particle { position = { 1, 0, 0 }, mass = 1 }
scene:pin({ o }, { path = function(t) return 0.1 * t, 0, 0 end })
scene:force("springs", { edges = { { o, p } }, k = k, rest = rest })
scene:measure("y", function(s) return s:position(p)[1] end)]], function(p)
  local w = math.sqrt(p.k) -- beside the pin: 1 - rest at first, with the speed -0.1
  return 0.1 + p.rest + (1 - p.rest) * math.cos(w) - 0.1 / w * math.sin(w)
end)

-- 8. Two masses and a spring fly through space: the centre by the start, the distance by k.
known("dumbbell", { k = 40, a = 1, b = 3, speed = 0.5 }, [[
local p = scene:particle { position = { 0, 0, 0 }, velocity = { speed, 0, 0 }, mass = a }
local q = scene:particle { position = { 1, 0, 0 }, velocity = { -0.2, 0, 0 }, mass = b }
scene:force("springs", { edges = { { p, q } }, k = k, rest = 1 })
scene:measure("y", function(s) return s:position(p)[1] end)]], function(p)
  local w, all = math.sqrt(p.k * (1 / p.a + 1 / p.b)), p.a + p.b
  local drift, apart = (p.a * p.speed - 0.2 * p.b) / all, (-0.2 - p.speed) / w * math.sin(w)
  return p.b / all + drift - p.b / all * (1 + apart)
end)

-- 9. A sheet of two triangles that is pulled along its warp: one strain, Green's, so with the stretch s of a square of side 1
-- m s'' = -stiffness s (s^2 - 1)/2 of a mass m at its free end. Not a closed form, but an equation of one variable: by
-- steps of the fourth order that are a quarter of those of the scene.
known("sheet", { stiffness = 3, m = 0.4, stretch = 1.2 }, [[
local o = { scene:particle { position = { 0, 0, 0 } }, scene:particle { position = { 0, 1, 0 } } }
local e = { scene:particle { position = { 1, 0, 0 }, mass = m / 2 }, scene:particle { position = { 1, 1, 0 }, mass = m / 2 } }
scene:pin(o)
for _, p in ipairs(e) do scene:pin({ p }, { axes = { 1, 0, 0 } }) end
scene:force("membrane", { triangles = { { o[1], e[1], e[2] }, { o[1], e[2], o[2] } }, model = "stvk", stiffness = stiffness,
  shear = 0 })
scene:force("central", { strength = 50 * (stretch - 1), per = "particle", power = 0, center = { 100, 0, 0 }, axis = { 0, 1, 0 } })
scene:measure("y", function(s) return s:position(e[1])[1] end)]], function(p)
  local x, v, h = 1, 0, 1 / 8192
  local function a(s) return (100 * (p.stretch - 1) - p.stiffness * s * (s * s - 1) / 2) / p.m end
  for _ = 1, 8192 do
    local k1 = a(x)
    local k2 = a(x + h / 2 * v)
    local k3 = a(x + h / 2 * v + h * h / 4 * k1)
    local k4 = a(x + h * v + h * h / 2 * k2)
    x, v = x + h * v + h * h / 6 * (k1 + k2 + k3), v + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
  end
  return x
end)

-- 10. A joint of two rods, one of which is held: a torsion pendulum of the angle, small because linear only there.
known("joint", { EI = 0.3, m = 0.5 }, [[
local a, b = scene:particle { position = { -1, 0, 0 } }, scene:particle { position = { 0, 0, 0 } }
local c = scene:particle { position = { 1, 0, 0 }, velocity = { 0, 0, 1e-6 }, mass = m }
scene:pin { a, b }
scene:force("angle_springs", { edges = { { a, b }, { b, c } }, EI = EI, normal = { 0, 1, 0 } })
scene:measure("y", function(s) return 1e6 * s:position(c)[3] end)]], function(p)
  local w = math.sqrt(2 * p.EI / p.m) -- k = 2 EI/l at a clamp
  return math.sin(w) / w
end)

-- ---- against whole runs beside ----

local function beside(name, at, body)
  local names = {}
  for key in pairs(at) do names[#names + 1] = key end
  table.sort(names)
  write(name .. ".lua", params_of(at) .. '\nlocal scene = hooke.scene { duration = 0.2, fps = 10, integrator = "leapfrog", dt = 5e-4 }\n'
    .. body .. "\nreturn scene\n")
  for _, way in ipairs { "forwards", "backwards" } do
    local code, text = gradient(("%s.lua --of y --by %s --way %s"):format(name, table.concat(names, ","), way))
    assert(code == 0 or code == 2 and not text:find("whole runs", 1, true), text)
    local rows = rows_of(name)
    for _, key in ipairs(names) do
      local row = rows[key]
      -- Whole runs differ by 7.6e-6 of the parameter, and their ends, of size 1, are rounded by some 400 steps: 20 eps.
      local rounding = 20 * 2 ^ -52 / (7.6e-6 * math.abs(at[key]))
      assert(math.abs(row.derivative - row.by_runs) <= 1e-6 * math.abs(row.by_runs) + rounding and row.derivative ~= 0,
        ("%s, %s: %s is %.12g, whole runs have %.12g\n%s"):format(name, way, key, row.derivative, row.by_runs, text))
    end
  end
end

local sheet = [[
local cloth = scene:grid { nx = 4, ny = 5, width = width, height = 1, mass = mass, alternating = true }
scene:pin { cloth:at(1, 1), cloth:at(1, 5) }
scene:force("gravity", { g = { 0, 2, -9.81 } })
scene:measure("y", function(s) return s:position(cloth:at(4, 3))[3] + s:position(cloth:at(4, 1))[1] end)
]]
beside("warp", { width = 1.1, mass = 0.2, stiffness = 6, weft = 3, shear = 0.7, damping = 0.003, turn = 0.3, rest = 0.97 },
  sheet .. [[scene:force("membrane", { stiffness = stiffness, weft = weft, shear = shear, damping = damping, rest = rest,
  warp = { math.cos(turn), math.sin(turn), 0 } })]])
beside("narrow", { width = 1.1, mass = 0.2, stiffness = 6, nu = 0.3, damping = 0.003 },
  sheet .. [[scene:force("membrane", { model = "stvk", stiffness = stiffness, nu = nu, damping = damping })]])
beside("rubber", { width = 1.1, mass = 0.2, stiffness = 6, nu = 0.4, damping = 0.003 },
  sheet .. [[scene:force("membrane", { model = "neo_hookean", stiffness = stiffness, nu = nu, damping = damping })]])
beside("bends", { width = 1.1, mass = 0.2, rigidity = 0.01, flat = 0.1, creep = 1e-4 }, sheet .. [[
scene:force("membrane", { stiffness = 6 })
scene:force("hinges", { rigidity = rigidity, rest = flat, damping = creep })]])
beside("plate", { width = 1.1, mass = 0.2, rigidity = 0.01 }, sheet .. [[
scene:force("membrane", { stiffness = 6 })
scene:force("quadratic_bending", { rigidity = rigidity })]])
beside("flesh", { long = 1.1, E = 300, nu = 0.35, damping = 0.4, density = 3 }, [[
local body = scene:block { nx = 4, ny = 3, nz = 3, size = { long, 0.5, 0.5 }, density = density }
for j = 1, 3 do for k = 1, 3 do scene:pin { body:at(1, j, k) } end end
scene:force("neo_hookean", { tetrahedra = body:tetrahedra(), E = E, nu = nu, damping = damping })
scene:force("gravity")
scene:measure("y", function(s) return s:position(body:at(4, 2, 2))[3] end)]])
beside("rod", { long = 1.1, EI = 0.02, curvature = 0.5, lag = 0.02, mass = 0.1 }, [[
local rod = scene:strand { n = 8, from = { 0, 0, 0 }, to = { long, 0, 0 }, mass = mass }
local id = rod:ids()
scene:pin { id[1], id[2] }
scene:force("springs", { edges = rod:edges(), k = 200 })
scene:force("angle_springs", { edges = rod:edges(), EI = EI, curvature = curvature, retardation = lag, normal = { 0, 1, 0 } })
scene:force("gravity")
scene:measure("y", function(s) return s:position(id[8])[3] end)]])
beside("well", { strength = 3, power = -1.5, softening = 0.3, range = 2, high = 0.2, lean = 0.4 }, [[
local p = scene:particle { position = { 0.7, 0.1, 0.4 }, velocity = { 0, 1, 0.5 } }
scene:force("central", { strength = strength, power = power, softening = softening, range = range, center = { 0, 0, high },
  axis = { lean, 1, 0.2 } })
scene:measure("y", function(s) return s:position(p)[1] + s:position(p)[3] end)]])

-- ---- what cannot be differentiated is named ----

local function one(name, body, wanted)
  write(name .. ".lua", 'local k = param("k", 10, "")\n' .. open .. [[
local p, q = scene:particle { position = { 1, 0, 0 } }, scene:particle { position = { 0, 0, 0 } }
scene:force("central", { strength = k })
scene:measure("y", function(s) return s:position(p)[1] end)
]] .. body .. "\nreturn scene\n")
  refused(name .. ".lua --of y --by k", wanted)
end
one("channel", 'scene:channel("heat", { initial = 1, rate = function() return -1 end })', "the scene has channels")
one("late", 'scene:force("drag", { d = k, from = 0.5 })', "force 'drag' begins or ends at a time")
one("let_go", 'scene:pin({ q }, { release = 0.5 })', "a pin is released at t = 0.5 s")
refused("late.lua --of y --by k --integrator tr_bdf2", "integrator 'tr_bdf2' does not state its step as stages")

runs.close()
