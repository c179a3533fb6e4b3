"""Reads a recording with h5py, by the rules of VTKHDF alone, and compares it with what the module `recording` gave:
recordings.py FILE FOLDER. FOLDER has positions.K, velocities.K, ids.K, edges.K of the frames K, and channel.K, force.K."""
import sys

import h5py
import numpy as np

path, folder = sys.argv[1:]
file = h5py.File(path, "r")
root = file["VTKHDF"]
steps = root["Steps"]
assert root.attrs["Type"] == b"UnstructuredGrid", root.attrs["Type"]
assert list(root.attrs["Version"]) == [2, 0]
frames = int(steps.attrs["NSteps"])


def wanted(name, k, kind):
    return np.fromfile(f"{folder}/{name}.{k + 1}", dtype=kind)


def rows(set, at, count):
    assert at + count <= set.shape[0], (set.name, at, count, set.shape)
    return set[at:at + count]


def cells(k, part):
    """Of each cell its type and its points."""
    count = int(root["NumberOfCells"][part])
    at = int(steps["CellOffsets"][k, 0])
    types = rows(root["Types"], at, count)
    offsets = rows(root["Offsets"], at + part, count + 1)
    points = rows(root["Connectivity"], int(steps["ConnectivityIdOffsets"][k, 0]), int(root["NumberOfConnectivityIds"][part]))
    assert offsets[0] == 0 and offsets[-1] == len(points)
    sizes = np.diff(offsets)
    assert all(sizes == np.choose(types, [0, 1, 0, 2, 0, 3]))
    return types, points


compared = 0
for k in range(frames):
    part = int(steps["PartOffsets"][k])
    assert steps["NumberOfParts"][k] == 1
    n = int(root["NumberOfPoints"][part])
    at = int(steps["PointOffsets"][k])
    assert np.array_equal(rows(root["Points"], at, n).astype(float).ravel(), wanted("positions", k, "<f8"))
    for name, set in root["PointData"].items():
        begin = int(steps["PointDataOffsets"][name][k])
        values = rows(set, begin, n)
        compared += 1
        if name == "velocity":
            assert np.array_equal(values.astype(float).ravel(), wanted("velocities", k, "<f8"))
        elif name == "id":
            assert np.array_equal(values, wanted("ids", k, "<u4"))
        elif "kind" in set.attrs:
            what = set.attrs["kind"].decode()
            label = set.attrs["label"].decode()
            assert np.array_equal(values.astype(float).ravel(), wanted(f"{what} {label}", k, "<f8")), name
    types, points = cells(k, part)
    first = int(np.sum(types == 1))
    segments = 2 * int(np.sum(types == 3))
    assert np.array_equal(points[first:first + segments], wanted("edges", k, "<u4"))
    assert np.array_equal(points[first + segments:], wanted("triangles", k, "<u4"))
    seen = np.zeros(n, bool)
    seen[points] = True
    assert seen.all(), "a particle in no cell"
    if "strain" in root["CellData"]:
        rows(root["CellData/strain"], int(steps["CellDataOffsets/strain"][k]), len(types))
    for name, set in root["FieldData"].items():
        rows(set, int(steps["FieldDataOffsets"][name][k]), 1)
print(f"{frames} frames, {compared} arrays")
