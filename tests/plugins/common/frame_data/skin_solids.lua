-- Surfaces of rigid bodies, in recordings: meshes whose frames go with the bodies, from frame to frame; a body without a
-- surface has none. Here a cube goes along x and turns uniformly about z; its mesh is given in its own frame.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
if not _G.hooke then os.exit(require("tool_tree").run(root, build, "tests/plugins/common/frame_data/skin_solids.lua")) end
local files = require("files")
local recording = require("tool_tree").recording()

local folder = files.folder()
files.write(folder .. "/bodies.lua", [[
local scene = hooke.scene { duration = 0.5, fps = 20, integrator = "leapfrog", dt = 1e-3 }
scene:rigid { mass = 1, inertia = { 1, 2, 2.5 }, position = { 9, 9, 9 } }
scene:rigid { mass = 2, velocity = { 3, 0, 0 }, spin = { 0, 0, 2 }, position = { 1, 0, 0 }, orientation = { 0, 0, 0.5 },
  parts = { { shape = "box", size = 1, position = { 0.5, 0, 0 } } } }
scene:output("trajectory", {})
return scene
]])
local log = folder .. "/log"
assert(os.execute(("cd %s && %s/hooke run bodies.lua --out out --quiet >log 2>&1"):format(folder, build)), files.read(log))
local r = assert(recording.open(folder .. "/out/trajectory.h5"))
assert(#r.solids == 1 and r.solids[1].kind == "mesh", "one body has a surface")
assert(#r.solids[1].vertices == 8 * 24 and #r.solids[1].faces == 12 * 12)
assert(string.unpack("<d", r.solids[1].vertices, 1) == 0) -- x of the first corner, 0.5 - 0.5

-- Leapfrog turns too fast by (w h)^2/24 of the angle: 1e-7 of 1 rad.
local function near(got, wanted)
  assert(math.abs(got - wanted) < 1e-6, ("%.9g, expected %.9g"):format(got, wanted))
end

for frame = 1, 11 do
  local t = (frame - 1) / 20
  local angle = 0.5 + 2 * t
  local c, s = math.cos(angle), math.sin(angle)
  local at = { string.unpack("<" .. ("d"):rep(12), r:solid_places(frame), 1) }
  local start = { 1 + math.cos(0.5) / 2, math.sin(0.5) / 2 } -- of the centre of mass, half a metre from the origin
  local wanted = { start[1] + 3 * t - c / 2, start[2] - s / 2, 0, c, s, 0, -s, c, 0, 0, 0, 1 }
  for k = 1, 12 do near(at[k], wanted[k]) end
end
r:close()
os.execute("rm -rf " .. files.quoted(folder))
