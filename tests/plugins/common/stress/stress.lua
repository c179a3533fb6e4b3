-- Tension and stress of scenes with known answers, as recordings have them: a chain of bars, its springs, a cable that is slack,
-- a bar of a solid under tension, a sheet that is pulled, and what pictures say where a scene has none.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
if not _G.hooke then os.exit(require("tool_tree").run(root, build, "tests/plugins/common/stress/stress.lua")) end
local files = require("files")
local recording = require("tool_tree").recording()

local folder = files.folder()

local function run(name, settings, body)
  files.write(("%s/%s.lua"):format(folder, name), ("local scene = hooke.scene { %s }\n%s\nreturn scene\n"):format(settings, body))
  local fine = os.execute(("cd %s && %s/hooke run %s.lua --out %s --quiet >log 2>&1"):format(folder, build, name, name))
  return fine, files.read(folder .. "/log")
end

-- Runs a scene -> the channel at its last frame, a number for each particle.
local function at_end(name, channel, settings, body)
  local fine, said = run(name, settings, body .. "\nscene:output('trajectory', { forces = true })")
  assert(fine, said)
  local r = assert(recording.open(("%s/%s/trajectory.h5"):format(folder, name)))
  local text, list = r:channel(channel, r.frames), {}
  assert(text, channel)
  for k = 1, #text, 8 do list[#list + 1] = (string.unpack("<d", text, k)) end
  r:close()
  return list
end

local function near(got, wanted, part, what)
  if got ~= got or math.abs(got - wanted) > part * math.abs(wanted) then
    error(("%s: %.12g, expected %.12g to %g"):format(what, got, wanted, part), 2)
  end
end

-- ---- bars: each carries what hangs below it, to the tolerance of multipliers ----

local hanging = [[
local chain = scene:strand { n = 9, length = 1.6, direction = { 0, 0, -1 }, mass = 0.9 }
scene:pin { chain:at(1) }
scene:force("gravity", { g = { 0, 0, -9.81 } })
]]
local settings = 'duration = 0.1, fps = 10, dt = 0.01, integrator = "leapfrog"'
local function masses_below(k) return 0.1 * (9 - k + 1) end -- of particle k and those below
local bars = at_end("bars", "tension N", settings, hanging .. 'scene:constraint("bars", { edges = chain:edges() })')
for k = 1, 9 do -- the upper bar of a particle has the larger force; the pin has the first one's
  near(bars[k], 9.81 * masses_below(math.max(k, 2)), 1e-9, "bar above particle " .. k)
end

-- ---- springs at rest: the same forces, from their lengths ----

local springs = at_end("springs", "tension N", 'duration = 20, fps = 0.1, dt = 0.002, integrator = "leapfrog"', hanging .. [[
scene:force("springs", { edges = chain:edges(), k = 1000, damping = 2 })
scene:force("drag", { rate = 4 })]])
for k = 1, 9 do near(springs[k], 9.81 * masses_below(math.max(k, 2)), 1e-6, "spring above particle " .. k) end

-- ---- cables: one hangs taut, one is slack ----

local cables = at_end("cables", "tension N", settings, [[
local p = { scene:particle { position = { 0, 0, 0 }, mass = 1 }, scene:particle { position = { 0, 0, -1 }, mass = 2 },
  scene:particle { position = { 1, 0, 0 }, mass = 1 }, scene:particle { position = { 1, 0, -1 }, mass = 1 } }
scene:pin { p[1], p[3], p[4] }
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:constraint("cables", { edges = { { p[1], p[2] }, { p[3], p[4] } }, length = { 1, 2 } })]])
near(cables[1], 2 * 9.81, 1e-9, "taut cable")
near(cables[2], 2 * 9.81, 1e-9, "taut cable")
assert(cables[3] == 0 and cables[4] == 0, "a slack cable has a force")

-- ---- solids: a bar that is stretched by a part e along x and free across, nu = 0 ----
-- Then F = diag(1 + e, 1, 1), and the stress along x is E e up to a part of the order of e: the energy is Hooke's to that order.

local E, k, e = 1e5, 100, 1e-3
local stretch = [[
local function stretch(particle, x) scene:pin({ particle }, { path = function(t) return 1e-3 * x * t / 0.1, 0, 0 end }) end
]]
local solid = at_end("solid", "solid_stress Pa", settings, stretch .. [[
local b = scene:block { nx = 4, ny = 3, nz = 3, size = { 1, 0.2, 0.2 }, mass = 1 }
scene:force("neo_hookean", { tetrahedra = b:tetrahedra(), E = 1e5, nu = 0 })
for i = 1, 4 do for j = 1, 3 do for k = 1, 3 do stretch(b:at(i, j, k), (i - 1) / 3) end end end]])
for i = 1, #solid do near(solid[i], E * e, 5 * e, "stress of the bar at " .. i) end

local sheet = at_end("sheet", "sheet_stress N/m", settings, stretch .. [[
local s = scene:grid { nx = 4, ny = 3, width = 1, height = 1, mass = 1 }
scene:force("membrane", { triangles = s:triangles(), model = "stvk", stiffness = 100, nu = 0 })
for i = 1, 4 do for j = 1, 3 do stretch(s:at(i, j), (i - 1) / 3) end end]])
for i = 1, #sheet do near(sheet[i], k * e, 5 * e, "stress of the sheet at " .. i) end

-- ---- what pictures refuse ----

local function refused(color, body, wanted)
  local fine, said = run("picture", settings, body .. ("\nscene:output('frames', { color = '%s', video = false })"):format(color))
  assert(not fine and said:find(wanted, 1, true), said)
end
local probe = os.execute(("test -e %s/plugins/outputs/frames.so"):format(build))
if probe then
  local one = "scene:particle { mass = 1 }"
  refused("tension", one, "color: 'tension' is that of springs, bars or cables, and the scene has none that tell it")
  refused("stress", one, "color: no force of the scene is one of sheets or solids that tells its stress; springs and bars have tension")
  refused("tensio", one, "did you mean 'tension'?")
  refused("stress", [[
local b, s = scene:block { nx = 2, ny = 2, nz = 2 }, scene:grid { nx = 2, ny = 2, width = 1, height = 1, mass = 1 }
scene:force("neo_hookean", { tetrahedra = b:tetrahedra(), E = 1e5 })
scene:force("membrane", { triangles = s:triangles(), stiffness = 100 })]], "say sheet_stress or solid_stress")
end

os.execute("rm -rf " .. files.quoted(folder))
