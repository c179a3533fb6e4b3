-- hooke convert RUN --to FORMAT: the motion that the output `trajectory` has kept, as files that other programs read.
local argparse = require("argparse")
local command_line = require("common.run.command_line")
local lfs = require("lfs")

local formats = { "ply", "obj", "vtk", "csv", "pc2", "xdmf", "vtkhdf", "gltf", "usd" }

local function parser()
  local p = argparse("hooke convert", "Converts what the output `trajectory` has kept.")
  p:argument("run", "a run's output folder, or the file trajectory.h5 itself")
  p:option("--to", "ply, obj, vtk: a file per frame; csv: a table of particles; pc2: a point cache and its mesh for"
    .. " Blender; gltf: one file with the motion, for Blender and browsers; usd: one text file of OpenUSD with the motion;"
    .. " vtkhdf, xdmf: HDF5 and XDMF files"):choices(formats):count(1)
  p:option("-o --out", "the folder of a sequence, or a file (RUN/FORMAT, RUN/converted.FORMAT)")
  p:option("--every", "a frame is taken every so many"):convert(command_line.whole("--every")):default(1)
  p:option("--from-frame", "the first, counted from 1"):convert(command_line.whole("--from-frame")):default(1)
  p:option("--to-frame", "the last"):convert(command_line.whole("--to-frame"))
  p:option("--ids", "csv: ids of the particles, 1,2,5 (all)")
  p:option("--isosurface", "the surface of the particles that are in no edge or triangle, in their stead (all but csv and pc2);"
    .. " m, their radius, half the distance of neighbours"):convert(command_line.number("--isosurface"))
  p:option("--cell", "of the surface, m: of the grid (half the radius)"):convert(command_line.positive("--cell"))
  p:option("--reach", "of the surface, m: how far a particle is felt (four radii; anisotropic: six)")
    :convert(command_line.positive("--reach"))
  p:option("--field", "of the surface: zhu_bridson (smooth; a single particle is a ball), density, or anisotropic"
    .. " (kernels that are flat along the surface; the flattest)")
    :choices({ "zhu_bridson", "density", "anisotropic" }):default("zhu_bridson")
  p:option("--threshold", "of the surface by density or anisotropic kernels: part of a full liquid's density,"
    .. " 0 to 1 (0.6; 0.25)")
    :convert(command_line.positive("--threshold"))
  p:option("--position-smoothing", "of anisotropic kernels: part of the way to the neighbours' mean, 0 to 1 (0.9)")
    :convert(command_line.number("--position-smoothing"))
  p:option("--stretch", "of anisotropic kernels: the largest ratio of their axes, 1 to 100 (4)")
    :convert(command_line.positive("--stretch"))
  p:option("--smoothing", "of the surface: rounds of smoothing of its mesh, up to 1000 (0); 25 take bumps away and leave drops")
    :convert(command_line.whole("--smoothing"))
  p:flag("--cut", "the surface ends at the scene's obstacles (but meshes), without bumps of particles there")
  p:option("--method", "of the surface: tetrahedra, or cubes, with a third of the triangles")
    :choices({ "tetrahedra", "cubes" }):default("tetrahedra")
  p:option("--up", "gltf, usd: the scene's axis that points up (z)"):choices({ "z", "y" })
  p:flag("--single", "vtkhdf, xdmf: numbers of particles in 32 bits")
  return p
end

local function complain(text) return command_line.complain("convert", text) end

-- The recording of a run, and the folder in which it is.
local function find(run)
  local kind = lfs.attributes(run, "mode")
  if not kind then return nil, ("%s is not there"):format(run) end
  if kind ~= "directory" then return run, run:match("^(.*)/[^/]*$") or "." end
  local file = run .. "/trajectory.h5"
  if lfs.attributes(file, "mode") then return file, run end
  return nil, ("%s has no trajectory.h5: let the scene write one, scene:output(\"trajectory\")"):format(run)
end

local function ids_of(text)
  local ids = {}
  for word in text:gmatch("[^,]+") do
    local id = math.tointeger(tonumber(word))
    if not id or id < 1 then return nil, ("--ids: '%s' is no id; expected 1,2,5"):format(word) end
    ids[#ids + 1] = id
  end
  return ids
end

local function is_sequence(format) return format == "ply" or format == "obj" or format == "vtk" end

-- Where the files go: the folder of a sequence, or the path of a file without its ending.
local function target(o, folder)
  if is_sequence(o.to) then return o.out or folder .. "/" .. o.to end
  return ((o.out or folder .. "/converted"):gsub("%.%w+$", ""))
end

local function make_folder(path)
  if lfs.attributes(path, "mode") == "directory" then return true end
  local made, why = lfs.mkdir(path)
  return made, ("cannot create the folder %s: %s"):format(path, why)
end

-- What is not converted, by name: what particles bounce off, pictures of rigid bodies, and what is felt at places of a frame.
local function left_out(recording, file)
  local r = recording.open(file)
  if not r then return {} end
  local list, kinds, bodies = {}, {}, 0
  for _, solid in ipairs(r.solids) do
    if solid.body then bodies = bodies + 1 else kinds[#kinds + 1] = solid.kind end
  end
  if #kinds > 0 then list[1] = ("obstacles (%s)"):format(table.concat(kinds, ", ")) end
  if bodies > 0 then
    list[#list + 1] = ("the shapes of rigid bodies (%d), but the triangles of those with body:surface()"):format(bodies)
  end
  for _, mark in ipairs(r.marks) do
    list[#list + 1] = mark.kind == "wind" and ("the wind of '%s'"):format(mark.name) or "points of contact"
  end
  r:close()
  return list
end

-- What was written, in words.
local files = { csv = "%s.csv", pc2 = "%s.pc2 and its mesh .obj", gltf = "%s.glb", usd = "%s.usda",
  xdmf = "%s.xdmf and .h5", vtkhdf = "%s.h5 and .xdmf" }

-- How the surface of particles is asked for; nil: it is not.
local function surface_of(o)
  if not o.isosurface then return nil end
  return { radius = o.isosurface, cell = o.cell, reach = o.reach, threshold = o.threshold, field = o.field,
    position_smoothing = o.position_smoothing, stretch = o.stretch, smoothing = o.smoothing, cubes = o.method == "cubes", cut = o.cut }
end

-- The sentence for an option of a surface that does not go with the others.
local function wrong_surface(o)
  if o.isosurface and (o.to == "csv" or o.to == "pc2") then
    return "--isosurface is for --to ply, obj, vtk, gltf, usd, vtkhdf or xdmf: a table or a point cache has no meshes that change"
  end
  local more = o.cell or o.reach or o.threshold or o.position_smoothing or o.stretch or o.smoothing or o.cut
  if not o.isosurface and (more or o.field ~= "zhu_bridson" or o.method ~= "tetrahedra") then
    return "--cell, --reach, --field and --method are of a surface: give --isosurface RADIUS"
  end
  if o.threshold and o.field == "zhu_bridson" then return "--threshold is for --field density or anisotropic" end
  if o.field ~= "anisotropic" and (o.position_smoothing or o.stretch) then
    return "--position-smoothing and --stretch are for --field anisotropic"
  end
  if (o.smoothing or 0) > 1000 then return ("--smoothing: %d rounds are more than 1000"):format(o.smoothing) end
  local part = o.position_smoothing or 0
  if part < 0 or part > 1 then return ("--position-smoothing: %g is no part from 0 to 1"):format(part) end
end

-- Writes it -> number of frames; or nil and the reason.
local function convert(c, o, base)
  if o.to == "csv" then return c:table(base .. ".csv", o.ids) end
  if o.to == "pc2" then return c:point_cache(base .. ".pc2", base .. ".obj") end
  if o.to == "gltf" then return c:gltf(base .. ".glb", o.up ~= "y", surface_of(o)) end
  if o.to == "usd" then return c:usd(base .. ".usda", o.up ~= "y", surface_of(o)) end
  if not is_sequence(o.to) then return c:recording(base .. ".h5", base .. ".xdmf", o.single, surface_of(o)) end
  return c:sequence(o.to, base, surface_of(o))
end

local o = command_line.parse("convert", parser())
if not o then return 1 end
local why
if o.ids then
  if o.to ~= "csv" then return complain("--ids is for --to csv") end
  o.ids, why = ids_of(o.ids)
  if not o.ids then return complain(why) end
end
why = wrong_surface(o)
if why then return complain(why) end
if o.up and o.to ~= "gltf" and o.to ~= "usd" then return complain("--up is for --to gltf or usd") end
local fine, conversion = pcall(require, "conversion")
if not fine then return complain("this hooke is built without HDF5: tools/install-deps run gets it; then make again") end
local file, folder = find(o.run)
if not file then
  complain(folder)
  return 4
end
local base = target(o, folder)
if lfs.attributes(base .. ".h5", "ino") == lfs.attributes(file, "ino") then
  return complain(("--out: %s.h5 is what is to be converted; name another file"):format(base))
end
-- From here on the process can do no more than read the recording and write beside the target: it may be a stranger's.
local beside = is_sequence(o.to) and base or base:match("^(.*)/[^/]*$") or "."
if is_sequence(o.to) then
  if not o.out and lfs.symlinkattributes(base, "mode") == "link" then
    return complain(("%s is a link: remove it, or name a folder with --out"):format(base))
  end
  fine, why = make_folder(base)
  if not fine then
    complain(why)
    return 4
  end
end
local recording = require("recording")
local open = hooke.confine(file, nil, beside == "" and "/" or beside)
if open then io.stderr:write("hooke convert: ", open, "\n") end
local c, frames
c, why = conversion.open(file, o.from_frame, o.to_frame, o.every)
if c then
  frames, why = convert(c, o, base)
  c:close()
end
if not frames then
  complain(why)
  return 4
end
print(("%d frames: %s"):format(frames, (files[o.to] or ("%s/000000." .. o.to .. " and so on")):format(base)))
local missing = left_out(recording, file)
if #missing > 0 then print("left out: " .. table.concat(missing, "; ")) end
return 0
