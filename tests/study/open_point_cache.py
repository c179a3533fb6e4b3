"""Opens a point cache in Blender: blender --background --python open_point_cache.py -- FOLDER. Loads the OBJ, gives it the
PC2 by the modifier Mesh Cache, and compares every vertex at every frame with the table converted.csv."""
import csv
import sys

import bpy

folder = sys.argv[sys.argv.index("--") + 1]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.obj_import(filepath=folder + "/converted.obj", forward_axis="Y", up_axis="Z")
mesh = bpy.context.selected_objects[0]
cache = mesh.modifiers.new("cache", "MESH_CACHE")
cache.cache_format = "PC2"
cache.filepath = folder + "/converted.pc2"
cache.forward_axis, cache.up_axis = "POS_Y", "POS_Z"
cache.frame_start = 0

frames = {}
with open(folder + "/converted.csv") as file:
    for t, _, *place in list(csv.reader(file))[1:]:  # t, id, x, y, z, ...
        frames.setdefault(t, []).append([float(c) for c in place[:3]])

largest = 0
for k, rows in enumerate(frames.values()):
    bpy.context.scene.frame_set(k)
    seen = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
    assert len(seen) == len(rows), f"{len(seen)} vertices, {len(rows)} particles"
    largest = max([largest] + [abs(a - b) for v, row in zip(seen, rows) for a, b in zip(v.co, row)])
print(f"Blender {bpy.app.version_string}: {len(frames)} frames of {len(rows)} vertices, {len(mesh.data.polygons)} faces, "
      f"off by {largest:.3g} m at most")
sys.exit(0 if largest < 1e-6 else 1)
