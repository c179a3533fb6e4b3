-- The scenes in which an integrator is tried, and what is done with it there. A scene is a function(scene) that fills
-- it; scenes.open starts a run of it with the method, which is then stepped by tools/native/method.c.
local inspect = require("inspect")
local method = require("method")

local scenes = {}

-- ---- scenes ----

-- Two masses on a string of springs that is released sideways; it also suits methods that work element by element.
local function string_of_springs(scene, damping)
  local ids, points = {}, { { 0, 0, 0 }, { 1, 0, 0.1 }, { 1.7, 0.4, -0.5 } }
  for k, x in ipairs(points) do ids[k] = scene:particle { position = x, mass = 1 } end
  scene:pin { ids[1] }
  scene:force("springs", { edges = { { ids[1], ids[2] }, { ids[2], ids[3] } }, k = 100, rest = 0.9, damping = damping })
  return ids
end

function scenes.swing(scene)
  string_of_springs(scene, 0)
  scene:force("gravity", {})
end

scenes.joints = { { 0, 0, 0 }, { 0.6, 0, -0.8 }, { 1.3, 0.4, -0.5 } }

function scenes.linkage(scene) -- two rigid bars below a pin
  local ids = {}
  for k, x in ipairs(scenes.joints) do ids[k] = scene:particle { position = x, mass = k } end
  scene:pin { ids[1] }
  scene:force("gravity", {})
  scene:constraint("bars", { edges = { { ids[1], ids[2] }, { ids[2], ids[3] } } })
end

function scenes.free(scene) -- the swing without its pin: the flow of a Hamiltonian in all coordinates
  local a = scene:particle { position = { 0, 0, 0 }, velocity = { 0, 0.4, 0 }, mass = 1 }
  local b = scene:particle { position = { 1.1, 0.2, 0 }, velocity = { 0.3, -0.5, 0.2 }, mass = 1 }
  local c = scene:particle { position = { 1.8, 0.9, 0.3 }, velocity = { 0, 0.2, -0.6 }, mass = 1 }
  scene:force("springs", { edges = { { a, b }, { b, c } }, k = 100, rest = 0.9 })
end

function scenes.damped(scene)
  string_of_springs(scene, 0.8)
  scene:force("gravity", {})
  scene:force("drag", { rate = 0.5 })
end

function scenes.driven(scene)
  string_of_springs(scene, 0)
  scene:force("gravity", { g = function(t) return { 4 * math.cos(7 * t), 3 * math.sin(11 * t), -9.81 } end })
end

function scenes.channels(scene)
  scene:channel("heat", { initial = 1, rate = -2 })
  scene:channel("dye", { size = 2, initial = { 0.5, 1 }, rate = function(t, _, a, b) return math.cos(5 * t) - b, a - b * b end })
  string_of_springs(scene, 0)
end

function scenes.sheet(scene)
  local cloth = scene:grid { nx = 16, ny = 16, width = 1, height = 1, mass = 0.3 }
  scene:pin { cloth:at(1, 16), cloth:at(16, 16) }
  scene:force("gravity", {})
  scene:force("springs", { edges = cloth:structural() .. cloth:shear(), k = 60, damping = 0.002 })
end

function scenes.curtain(scene) -- of several blocks of particles
  local cloth = scene:grid { nx = 64, ny = 70, width = 4, height = 4, mass = 2 }
  scene:pin { cloth:at(1, 70), cloth:at(64, 70) }
  scene:force("gravity", {})
  scene:force("springs", { edges = cloth:structural(), k = 20, damping = 0.001 })
end

scenes.OFFSET = 1e-8 -- m, of a spring of 1 m: linear to the eighth digit, and growth by a million still to the second

-- One particle on a spring to a pin, displaced from rest: h w for steps of 1/60 s.
function scenes.oscillator(hw, damping)
  local w = 60 * hw
  return function(scene)
    local a = scene:particle { position = { 0, 0, 0 }, mass = 1 }
    local b = scene:particle { position = { 1 + scenes.OFFSET, 0, 0 }, mass = 1 }
    scene:pin { a }
    scene:force("springs", { edges = { { a, b } }, k = w * w, damping = 2 * damping * w, rest = 1 })
  end
end

-- One particle in a plane, pulled to the origin, damped and turned by a field: exactly linear.
function scenes.turning(hw, hg, hb)
  return function(scene)
    scene:particle { position = { 1, 0, 0 }, velocity = { 0, 30 * (hw + math.abs(hb)), 0 }, mass = 1 }
    scene:force("central", { strength = 3600 * hw * hw })
    if hg > 0 then scene:force("drag", { rate = 60 * hg }) end
    scene:force("magnetic", { B = { 0, 0, 60 * hb }, ratio = 1 })
  end
end

-- ---- runs ----

-- A run of the scene at its start, and the scene; or nil and why the plugin does not take it. options: threads, tol, dt.
function scenes.open(plugin, fill, options)
  options = options or {}
  local scene = hooke.scene { duration = 100, dt = not plugin.adaptive and (options.dt or 1 / 240) or nil,
    tol = plugin.adaptive and (options.tol or 1e-6) or nil }
  local fine, why = pcall(function()
    scene:integrator(plugin.path, options.params or plugin.given)
    fill(scene)
  end)
  if not fine then return nil, tostring(why) end
  inspect.threads(scene, options.threads or 1)
  inspect.allocations(scene, options.allocations or 0)
  local run
  fine, run = pcall(scene.run, scene, { to = 0 })
  if not fine then return nil, tostring(run):find("%S") and tostring(run) or "it fails and does not say why" end
  return run, scene
end

-- The X at time T after `steps` equal steps, or as many as an adaptive method takes; nil and why.
function scenes.advance(plugin, fill, T, steps, options)
  local run, why = scenes.open(plugin, fill, options)
  if not run then return nil, why end
  local report = method.run(run, plugin.adaptive and { stop = T, h = T / steps } or { h = T / steps, steps = steps })
  if report.status ~= 0 then return nil, "a step fails: " .. report.message end
  return report.X, report
end

-- The root mean square of the differences of the numbers first to last.
function scenes.distance(a, b, first, last)
  local sum = 0
  first, last = first or 1, last or #a
  for k = first, last do sum = sum + (a[k] - b[k]) ^ 2 end
  return math.sqrt(sum / math.max(1, last - first + 1))
end

return scenes
