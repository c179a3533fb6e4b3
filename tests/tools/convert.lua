-- hooke convert --isosurface: the surface of loose particles in their stead, closed, with their velocity, beside cloth that
-- stays; and what it says of wrong options.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
if not _G.hooke then os.exit(require("tool_tree").run(root, build, "tests/tools/convert.lua")) end
local files = require("files")
require("tool_tree").recording()

local folder = files.folder()
local function at(name) return folder .. "/" .. name end

-- Runs hooke -> whether it ended well, what it printed.
local function hooke(format, ...)
  local fine = os.execute(("cd %s && %s/hooke %s >log 2>&1"):format(folder, build, format:format(...)))
  return fine, files.read(at("log"))
end

local function must(format, ...)
  local fine, said = hooke(format, ...)
  assert(fine, said)
end

-- One drop of radius 0.1 m that flies at 2 m/s, another beside it, and a square of cloth far away.
files.write(at("drops.lua"), [[
local scene = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog", dt = 1e-2 }
scene:particle { position = { 0, 0, 0 }, velocity = { 2, 0, 0 }, mass = 1 }
scene:particle { position = { 5, 0, 0 }, velocity = { 0, 0, 3 }, mass = 1 }
local cloth = scene:mesh { vertices = { { 9, 9, 0 }, { 10, 9, 0 }, { 9, 10, 0 } }, faces = { { 1, 2, 3 } }, mass = 1 }
scene:pin(cloth:ids())
scene:channel("dye", { initial = 7 })
scene:output("trajectory", {})
return scene
]])
must("run drops.lua --quiet --trust --out out")

-- ---- OBJ: the mesh ----

local function read_obj(path)
  local mesh = { x = {}, triangle = {} }
  for line in io.lines(path) do
    local kind, a, b, c = line:match("^(%a) (%S+) (%S+) (%S+)")
    if kind == "v" then mesh.x[#mesh.x + 1] = { tonumber(a), tonumber(b), tonumber(c) } end
    if kind == "f" then mesh.triangle[#mesh.triangle + 1] = { tonumber(a), tonumber(b), tonumber(c) } end
  end
  return mesh
end

-- The volume within triangles of vertices nearer than 1 m to a place, and how many of their edges are open.
local function volume_near(mesh, x0)
  local sum, open = 0, {}
  for _, t in ipairs(mesh.triangle) do
    local p, q, r = mesh.x[t[1]], mesh.x[t[2]], mesh.x[t[3]]
    if math.abs(p[1] - x0) < 1 then
      sum = sum + ((p[1] - x0) * (q[2] * r[3] - q[3] * r[2]) + (q[1] - x0) * (r[2] * p[3] - r[3] * p[2])
        + (r[1] - x0) * (p[2] * q[3] - p[3] * q[2])) / 6
      for k = 1, 3 do
        local a, b = t[k], t[k % 3 + 1]
        local key = math.min(a, b) .. " " .. math.max(a, b)
        open[key] = (open[key] or 0) + (a < b and 1 or -1)
      end
    end
  end
  local broken = 0
  for _, uses in pairs(open) do broken = broken + (uses ~= 0 and 1 or 0) end
  return sum, broken
end

local ball = 4 / 3 * math.pi * 0.1 ^ 3
for _, method in ipairs { "tetrahedra", "cubes" } do
  must("convert out --to obj --isosurface 0.1 --cell 0.02 --method %s --out obj_%s", method, method)
  local mesh = read_obj(at(("obj_%s/000001.obj"):format(method)))
  for _, place in ipairs { 0.2, 5 } do -- where the drops are in the second frame
    local volume, broken = volume_near(mesh, place)
    assert(broken == 0, ("%d edges are open"):format(broken))
    assert(math.abs(volume / ball - 1) < 0.03, ("a drop has the volume %g of %g"):format(volume, ball)) -- cells of radius/5
  end
  local cloth = 0
  for _, x in ipairs(mesh.x) do cloth = cloth + (x[1] > 8 and 1 or 0) end
  assert(cloth == 3, "the cloth has stayed as it was")
end

-- One particle by anisotropic kernels is a ball of 1.36 radii, 2.5 times the volume, and smaller kernels of a lower threshold
-- are told apart.
must("convert out --to obj --isosurface 0.1 --cell 0.02 --field anisotropic --out kernels")
local volume, broken = volume_near(read_obj(at("kernels/000001.obj")), 5)
assert(broken == 0 and volume / ball > 2.3 and volume / ball < 2.7, ("a drop has the volume %g of %g"):format(volume, ball))
must("convert out --to obj --isosurface 0.1 --cell 0.02 --field anisotropic --threshold 0.05 --position-smoothing 0"
  .. " --stretch 2 --out wide")
local wide = volume_near(read_obj(at("wide/000001.obj")), 5)
assert(wide > 1.3 * volume, "a lower threshold has more within")

-- A drop by itself is not smoothed.
must("convert out --to obj --isosurface 0.1 --cell 0.02 --smoothing 25 --out smooth")
assert(files.read(at("smooth/000001.obj")) == files.read(at("obj_tetrahedra/000001.obj")), "a lone drop keeps its shape")

-- A drop half in the floor ends there when it is asked to.
files.write(at("rest.lua"), [[
local scene = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog", dt = 1e-2 }
scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:corrector("obstacle", { shape = "plane", normal = { 0, 0, 1 } })
scene:output("trajectory", {})
return scene
]])
must("run rest.lua --quiet --trust --out rest")
for _, cut in ipairs { "", "--cut" } do
  must("convert rest --to obj --isosurface 0.1 --cell 0.02 %s --out rest%s", cut, cut)
  local mesh, low = read_obj(at(("rest%s/000000.obj"):format(cut))), 1
  for _, x in ipairs(mesh.x) do low = math.min(low, x[3]) end
  local size, open = volume_near(mesh, 0)
  assert(open == 0 and math.abs(low - (cut == "" and -0.1 or 0)) < 2e-3, ("%s: from %g m"):format(cut, low)) -- a tenth of a cell
  assert(math.abs(size / ball - (cut == "" and 1 or 0.5)) < 0.06, ("%s: the volume %g of %g"):format(cut, size, ball))
end

-- ---- PLY: numbers at the vertices ----

must("convert out --to ply --isosurface 0.1 --field zhu_bridson --out ply")
local text = files.read(at("ply/000001.ply"))
local head = text:match("^.-end_header\n")
assert(head:find("property double dye\n", 1, true), head)
local count, size = tonumber(head:match("element vertex (%d+)")), 7 * 8 + 4 + 1 + 8 -- x, v, mass, id, pin, dye
assert(count > 200)
local ids = {}
for k = 0, count - 1 do
  local x, _, _, vx, _, vz, mass, id, _, dye = string.unpack("<dddddddI4Bd", text, #head + 1 + k * size)
  if x < 8 then
    local first = x < 2
    local off = math.max(math.abs(vx - (first and 2 or 0)), math.abs(vz - (first and 0 or 3)), math.abs(dye - 7))
    assert(off < 1e-14 and mass == 0, "a vertex has its drop's numbers") -- a product and a quotient: rounding
  end
  assert(not ids[id], "ids differ")
  ids[id] = true
end

-- ---- VTKHDF: a recording whose particles are the surface's vertices, for pages and for what reads recordings ----

must("convert out --to vtkhdf --isosurface 0.1 --cell 0.02 --out surface")
must("convert surface.h5 --to obj --out again")
for frame, place in ipairs { 0, 0.2 } do -- of the drop that flies; another mesh at each frame
  local name = ("%06d.obj"):format(frame - 1)
  local drop, holes = volume_near(read_obj(at("again/" .. name)), place)
  assert(holes == 0 and math.abs(drop / ball - 1) < 0.03, ("%s: volume %g of %g"):format(name, drop, ball))
  assert(files.read(at("again/" .. name)) == files.read(at("obj_tetrahedra/" .. name)), name .. " is that of a direct way")
end
must("view surface.h5 --page page.html --quiet")
assert(files.read(at("page.html")):find("</html>", 1, true))
must("convert out --to vtk --isosurface 0.1 --cell 0.02 --out vtk")
local vtk = files.read(at("vtk/000001.vtk"))
assert(tonumber(vtk:match("POINTS (%d+) double")) == #read_obj(at("obj_tetrahedra/000001.obj")).x)

-- ---- a cloud that is no liquid, and wrong options ----

local function refused(words, said)
  local fine, printed = hooke("convert out %s", words)
  assert(not fine and printed:find(said, 1, true), printed)
end

refused("--to obj --isosurface 0.1 --field density", "--isosurface: isosurface: no surface in the box")
refused("--to csv --isosurface 0.1", "--isosurface is for --to ply, obj, vtk, gltf, usd, vtkhdf or xdmf")
refused("--to pc2 --isosurface 0.1", "a table or a point cache has no meshes that change")
refused("--to obj --cell 0.1", "--cell, --reach, --field and --method are of a surface: give --isosurface RADIUS")
refused("--to obj --isosurface 0.1 --threshold 0.5", "--threshold is for --field density or anisotropic")
refused("--to obj --isosurface 0.1 --field density --threshold 1", "a threshold of 1: ")
refused("--to obj --isosurface 0.1 --stretch 2", "--position-smoothing and --stretch are for --field anisotropic")
refused("--to obj --isosurface 0.1 --field anisotropic --position-smoothing=-1", "--position-smoothing: -1 is no part from 0 to 1")
refused("--to obj --isosurface 0.1 --field anisotropic --stretch 0.5", "kernels stretched up to 0.5")
refused("--to obj --isosurface 0.1 --cell 0", "--cell: '0' is not a positive number")
refused("--to obj --isosurface 0.1 --reach=-1", "--reach: '-1' is not a positive number")
refused("--to obj --isosurface 0.1 --smoothing 1001", "--smoothing: 1001 rounds are more than 1000")
refused("--to obj --cut", "give --isosurface RADIUS")
refused("--to obj --smoothing 5", "give --isosurface RADIUS")
refused("--to obj --isosurface 0", "--isosurface")
refused("--to obj --isosurface 1e-9", "take larger ones, or leave out what has flown away")
refused("--to obj --isosurface 0.1 --reach 0.01", "the reach is no less than the radius")

-- ---- what is left out, by name: the shapes of bodies are no obstacles ----

files.write(at("bodies.lua"), [[
local scene = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog", dt = 1e-2 }
for k = 1, 2 do scene:rigid { shape = "box", size = { 1, 1, 1 }, mass = 1, position = { 2 * k, 0, 3 } } end
scene:corrector("obstacle", { shape = "sphere", radius = 1 })
scene:output("trajectory", {})
return scene
]])
must("run bodies.lua --quiet --no-check --out bodies")
local _, said = hooke("convert bodies --to vtk")
assert(said:find("left out: obstacles (sphere); the shapes of rigid bodies (2), but", 1, true), said)

os.execute("rm -r " .. files.quoted(folder))
print("passed")
