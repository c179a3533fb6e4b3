-- Wind and points of contact in recordings: the wind is what the scene says, at places of particles, while it blows; points
-- lie where bodies touch, in the middle between surfaces; of many, some are kept, and how many there were.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
if not _G.hooke then os.exit(require("tool_tree").run(root, build, "tests/plugins/common/frame_data/marks.lua")) end
local files = require("files")
local recording = require("tool_tree").recording()

local folder = files.folder()

-- Runs a scene for half a second, its recording.
local function run(name, body)
  files.write(("%s/%s.lua"):format(folder, name), ([[
local scene = hooke.scene { duration = 0.5, fps = 20, integrator = "leapfrog", dt = 1e-3 }
%s
scene:output("trajectory", {})
return scene
]]):format(body))
  assert(os.execute(("cd %s && %s/hooke run %s.lua --out %s --quiet >log 2>&1"):format(folder, build, name, name)),
    files.read(folder .. "/log"))
  return assert(recording.open(("%s/%s/trajectory.h5"):format(folder, name)))
end

local function numbers(text)
  local list = {}
  for at = 1, #text, 8 do list[#list + 1] = (string.unpack("<d", text, at)) end
  return list
end

-- They are kept in 32 bits.
local function near(got, wanted, what)
  if got ~= got or math.abs(got - wanted) > 1e-6 * math.max(1, math.abs(wanted)) then
    error(("%s: %.9g, expected %.9g"):format(what, got, wanted), 2)
  end
end

-- ---- wind ----

local r = run("wind", [[
for i = 1, 600 do scene:particle { position = { i, 0, 0 } } end
scene:force("wind", { on = "particles", d = 1e-9, velocity = function(t) return { 1 + t, 0, -t } end, label = "breeze" })
scene:force("vortex", { d = 1e-9, strength = 1, to = 0.26 })
]])
assert(#r.marks == 2 and r.marks[1].name == "breeze" and r.marks[1].kind == "wind" and r.marks[2].name == "vortex")
for k = 1, r.frames do
  local places, vectors, total = r:marks_of(1, k)
  local x, u, t = numbers(places), numbers(vectors), r.times[k]
  assert(#x == 600 and total == 600, ("%d numbers, of %d particles"):format(#x, total)) -- every third of the 600
  for i = 1, #x, 3 do
    near(x[i], i, "place") -- particles 1, 4, 7, ...; they hardly move
    near(u[i], 1 + t, "wind")
    near(u[i + 2], -t, "wind")
  end
  assert((#r:marks_of(2, k) > 0) == (t < 0.26), "a force that does not act at this time")
end
r:close()

-- ---- obstacles: a particle at rest on a plane, one above it ----

r = run("plane", [[
scene:particle { position = { 2, 3, 0.1 } }
scene:particle { position = { 0, 0, 9 } }
scene:force("gravity", {})
scene:corrector("obstacle", { radius = 0.1 })
]])
assert(#r.marks == 1 and r.marks[1].kind == "contact")
for k = 2, r.frames do
  local places, normals = r:marks_of(1, k)
  local x, n = numbers(places), numbers(normals)
  assert(#x == 3, ("%d points"):format(#x // 3))
  near(x[1], 2, "x")
  near(x[3], 0, "on the plane")
  near(n[3], 1, "normal")
end
r:close()

-- ---- soft grains, and a soft obstacle: in the middle, within the overlap ----

r = run("soft", [[
for i = 0, 1 do scene:particle { position = { 0.19 * i, 0, 5 } } end
scene:particle { position = { 0, 1, 0.09 } }
scene:force("soft_spheres", { radius = 0.1, stiffness = 10, restitution = 1 })
scene:force("penalty", { radius = 0.1, k = 10 })
]])
local places = numbers((r:marks_of(1, 1)))
assert(#places == 3, "at the start: that of the obstacle; grains remember what they touched after a step")
near(places[2], 1, "y")
near(places[3], -0.01, "the lowest point of the ball")
r:close()

-- ---- surfaces: a card on a pinned one, by the force and by the corrector ----

for _, how in ipairs { [[scene:force("repulsion", { thickness = 0.02 })]], [[scene:corrector("contact", { thickness = 0.02 })]] } do
  r = run("cards", [[
local below = scene:grid { nx = 4, ny = 4, width = 1, height = 1, mass = 0.1 }
scene:pin(below)
local card = scene:grid { nx = 3, ny = 3, width = 0.5, height = 0.5, mass = 0.1, origin = { 0.21, 0.23, 0.0201 } }
scene:force("springs", { edges = card:structural(), k = 100, damping = 1 })
scene:force("gravity", { g = { 0, 0, -9.81 } })
]] .. how)
  local x, n = r:marks_of(1, r.frames)
  x, n = numbers(x), numbers(n)
  assert(#x >= 3 * 3, "a card lies on three points at least")
  for i = 1, #x, 3 do
    assert(math.abs(x[i + 2] - 0.01) < 0.006, ("a point between the cards, not at z = %g"):format(x[i + 2]))
    assert(math.abs(n[i + 2]) > 0.9, "a normal that is upright")
  end
  r:close()
end

-- ---- many ----

r = run("many", [[
for i = 1, 2500 do scene:particle { position = { i, 0, 0 } } end
scene:force("gravity", {})
scene:corrector("obstacle", {})
]])
local at, _, total = r:marks_of(1, r.frames)
assert(total == 2500 and #at // 24 == 834, ("%d of %d"):format(#at // 24, total)) -- every third
r:close()
os.execute("rm -rf " .. files.quoted(folder))
