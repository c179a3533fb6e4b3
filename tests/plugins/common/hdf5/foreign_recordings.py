"""Makes of a good recording one that a stranger may have written: foreign_recordings.py GOOD SECRET NAME TARGET; NAME
"list" prints the names. Each has one thing that no recording of hooke has."""
import ctypes
import shutil
import sys

import h5py
import numpy as np


def replaced(file, path, make):
    group, name = path.rsplit("/", 1)
    del file[path]
    make(file[group], name)


def array_of_texts(file):
    own = file["hooke"].attrs
    length = own.get_id("verdict").get_type().get_size()
    del own["verdict"]
    own.create("verdict", np.array([b"x" * length] * 4096, dtype=f"S{length}"))


def array_of_labels(file):
    attrs = file["VTKHDF/PointData/heat"].attrs
    del attrs["label"]
    attrs.create("label", np.array([b"A" * 60] * 9000, dtype="S60"))


def array_of_numbers(file):
    steps = file["VTKHDF/Steps"].attrs
    del steps["NSteps"]
    steps.create("NSteps", np.zeros(100000, dtype="i8"))


def external_storage(file):
    def make(group, name):
        size = 3 * 8 * 4
        group.create_dataset(name, (4, 3), dtype="f8", external=[(secret, 0, size)])

    replaced(file, "VTKHDF/PointData/velocity", make)


def external_link(file):
    replaced(file, "VTKHDF/PointData/velocity", lambda g, n: g.__setitem__(n, h5py.ExternalLink(good, "/VTKHDF/Points")))


def external_group(file):
    replaced(file, "VTKHDF/FieldData", lambda g, n: g.__setitem__(n, h5py.ExternalLink(good, "/VTKHDF/FieldData")))


def soft_link(file):
    replaced(file, "VTKHDF/PointData/velocity", lambda g, n: g.__setitem__(n, h5py.SoftLink("/VTKHDF/Points")))


class LinkClass(ctypes.Structure):
    """H5L_class_t, version 0: what a link does when it is followed is its own function's."""
    _fields_ = [("version", ctypes.c_int), ("id", ctypes.c_int), ("comment", ctypes.c_char_p),
                ("create", ctypes.c_void_p), ("move", ctypes.c_void_p), ("copy", ctypes.c_void_p),
                ("traverse", ctypes.c_void_p), ("delete", ctypes.c_void_p), ("query", ctypes.c_void_p)]


def make_own_link(group, name):
    """A link of a kind that this file's writer has defined; h5py has no function for it, the library it uses does."""
    path = next(line.split()[-1] for line in open("/proc/self/maps") if "libhdf5" in line and "_hl" not in line)
    library, kind = ctypes.CDLL(path), 187
    follow = ctypes.CFUNCTYPE(ctypes.c_int64)(lambda: -1)
    own = LinkClass(0, kind, b"own", None, None, None, ctypes.cast(follow, ctypes.c_void_p), None, None)
    assert library.H5Lregister(ctypes.byref(own)) >= 0
    create = library.H5Lcreate_ud
    create.argtypes = [ctypes.c_int64, ctypes.c_char_p, ctypes.c_int, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int64,
                       ctypes.c_int64]
    value = secret.encode()
    assert create(group.id.id, name.encode(), kind, value, len(value), 0, 0) >= 0


def own_link(file):
    replaced(file, "VTKHDF/PointData/velocity", make_own_link)


def own_link_to_a_group(file):
    replaced(file, "VTKHDF/FieldData", make_own_link)


def own_link_to_the_description(file):
    del file["hooke"]
    make_own_link(file, "hooke")


def external_description(file):
    del file["hooke"]
    file["hooke"] = h5py.ExternalLink(good, "/hooke")


def virtual(file):
    rows = file["VTKHDF/Points"].shape[0]

    def make(group, name):
        layout = h5py.VirtualLayout(shape=(rows, 3), dtype="f8")
        layout[:] = h5py.VirtualSource(good, "/VTKHDF/Points", shape=(rows, 3))
        group.create_virtual_dataset(name, layout)

    replaced(file, "VTKHDF/PointData/velocity", make)


def compound(file):
    rows = file["VTKHDF/PointData/mass"].shape[0]
    kind = np.dtype([("a", "f8"), ("b", "f8")])
    replaced(file, "VTKHDF/PointData/mass", lambda g, n: g.create_dataset(n, (rows,), dtype=kind))


def texts_for_numbers(file):
    rows = file["VTKHDF/PointData/mass"].shape[0]
    kind = h5py.string_dtype()
    replaced(file, "VTKHDF/PointData/mass", lambda g, n: g.create_dataset(n, (rows,), dtype=kind))


def three_dimensions(file):
    rows = file["VTKHDF/PointData/velocity"].shape[0]
    replaced(file, "VTKHDF/PointData/velocity", lambda g, n: g.create_dataset(n, (rows, 3, 2), dtype="f8"))


def too_wide(file):
    rows = file["VTKHDF/PointData/heat"].shape[0]
    kept = dict(file["VTKHDF/PointData/heat"].attrs)
    replaced(file, "VTKHDF/PointData/heat", lambda g, n: g.create_dataset(n, (rows, 1 << 20), dtype="f8", chunks=(1, 1024)))
    for name, value in kept.items():
        file["VTKHDF/PointData/heat"].attrs[name] = value


def more_particles_than_bytes(file):
    shape = (1 << 31, 3)
    for path in ("VTKHDF/Points", "VTKHDF/PointData/velocity"):
        replaced(file, path, lambda g, n: g.create_dataset(n, shape, dtype="f8", chunks=(1024, 3)))
    file["VTKHDF/NumberOfPoints"][...] = 1 << 31


def more_frames_than_bytes(file):
    replaced(file, "VTKHDF/Steps/Values", lambda g, n: g.create_dataset(n, (1 << 40,), dtype="f8", chunks=(1024,)))
    file["VTKHDF/Steps"].attrs["NSteps"] = 1 << 40


def written_again(file, path, prepare):
    """The dataset with the same numbers, made with properties of its own."""
    numbers = file[path][...]
    kept = dict(file[path].attrs)

    def make(group, name):
        properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        prepare(properties, numbers.shape)
        space = h5py.h5s.create_simple(numbers.shape, (h5py.h5s.UNLIMITED,) * numbers.ndim)
        made = h5py.Dataset(h5py.h5d.create(group.id, name.encode(), h5py.h5t.py_create(numbers.dtype), space, properties))
        made[...] = numbers
        for key, value in kept.items():
            made.attrs[key] = value

    replaced(file, path, make)


def deflated_twice(file):
    def prepare(properties, shape):
        properties.set_chunk(shape)
        properties.set_deflate(1)
        properties.set_deflate(9)

    written_again(file, "VTKHDF/PointData/velocity", prepare)


def filter_of_others(file):
    def prepare(properties, shape):
        properties.set_chunk(shape)
        properties.set_filter(h5py.h5z.FILTER_NBIT, 0, ())

    written_again(file, "VTKHDF/PointData/velocity", prepare)


def chunk_of_gigabytes(file):
    def prepare(properties, shape):
        properties.set_chunk((1 << 27,) + shape[1:])
        properties.set_alloc_time(h5py.h5d.ALLOC_TIME_INCR)

    rows = file["VTKHDF/PointData/mass"].shape[0]
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    prepare(properties, (rows,))
    del file["VTKHDF/PointData/mass"]
    space = h5py.h5s.create_simple((rows,), (h5py.h5s.UNLIMITED,))
    h5py.h5d.create(file["VTKHDF/PointData"].id, b"mass", h5py.h5t.IEEE_F64LE, space, properties)


def text_of_gigabytes(file):
    kind = h5py.h5t.C_S1.copy()
    kind.set_size(4000000000)
    del file["hooke/origin"]
    h5py.h5d.create(file["hooke"].id, b"origin", kind, h5py.h5s.create(h5py.h5s.SCALAR))


def names_for_the_same_bytes(file):
    for k in range(5000):
        file["VTKHDF/PointData/heat%d" % k] = file["VTKHDF/PointData/heat"]


def names_for_the_same_series(file):
    for k in range(5000):
        file["VTKHDF/FieldData/work%d" % k] = file["VTKHDF/FieldData/work"]


def group_in_itself(file):
    file["VTKHDF/PointData/again"] = file["VTKHDF"]


def more_frames_than_rows(file):
    file["VTKHDF/Steps"].attrs["NSteps"] = file["VTKHDF/Steps/Values"].shape[0] + 1


def negative_frames(file):
    file["VTKHDF/Steps"].attrs["NSteps"] = -1


def more_particles_than_rows(file):
    file["VTKHDF/NumberOfPoints"][...] = 100000


def rows_before_the_first(file):
    file["VTKHDF/Steps/PointOffsets"][1] = -4


def cells_that_do_not_exist(file):
    file["hooke/Cells"][0] = (1 << 30, 0, 0)


def corners_that_do_not_exist(file):
    file["VTKHDF/Connectivity"][...] = 1 << 20


def part_that_does_not_exist(file):
    file["VTKHDF/Steps/PartOffsets"][1] = 1000


kinds = [array_of_texts, array_of_labels, array_of_numbers, external_storage, external_link, external_group, soft_link,
         own_link, own_link_to_a_group, own_link_to_the_description, external_description, virtual, compound, texts_for_numbers, three_dimensions, too_wide, more_particles_than_bytes,
         more_frames_than_bytes, more_frames_than_rows, negative_frames, more_particles_than_rows, rows_before_the_first,
         cells_that_do_not_exist, corners_that_do_not_exist, part_that_does_not_exist, deflated_twice, filter_of_others,
         chunk_of_gigabytes, text_of_gigabytes, names_for_the_same_bytes, names_for_the_same_series, group_in_itself]
good, secret, name, target = sys.argv[1:]
if name == "list":
    print("\n".join(kind.__name__ for kind in kinds))
else:
    shutil.copyfile(good, target)
    with h5py.File(target, "r+") as opened:
        next(kind for kind in kinds if kind.__name__ == name)(opened)
