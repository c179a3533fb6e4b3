"""libhooke by ctypes: where it is, its functions, and one run of it (see hooke.h)."""
import ctypes
import os
import pathlib
import threading

_TEXT, _RUN, _STATUS = ctypes.c_char_p, ctypes.c_void_p, ctypes.c_int
_FRAME = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)

# name: (result, arguments after the run)
_FUNCTIONS = {
    "new": (_RUN, None),
    "free": (None, []),
    "error": (_TEXT, []),
    "parameter": (_STATUS, [_TEXT, _TEXT]),
    "option": (_STATUS, [_TEXT, _TEXT]),
    "open": (_STATUS, [_TEXT]),
    "open_text": (_STATUS, [_TEXT, _TEXT]),
    "on_frame": (_STATUS, [_FRAME, ctypes.c_void_p]),
    "finish": (_STATUS, []),
    "stop": (None, []),
    "time": (ctypes.c_double, []),
    "count": (ctypes.c_size_t, []),
    "positions": (ctypes.c_void_p, []),
    "velocities": (ctypes.c_void_p, []),
    "masses": (ctypes.c_void_p, []),
    "ids": (ctypes.c_void_p, []),
    "order": (ctypes.c_void_p, []),
    "channel": (ctypes.c_void_p, [_TEXT, ctypes.POINTER(ctypes.c_size_t)]),
    "channel_name": (_TEXT, [ctypes.c_size_t]),
    "energy": (None, [ctypes.POINTER(ctypes.c_double)] * 3),
    "measure_name": (_TEXT, [ctypes.c_size_t]),
    "measure": (ctypes.c_double, [ctypes.c_size_t]),
    "checkpoint": (_STATUS, [_TEXT]),
    "write_state": (_STATUS, [_TEXT]),
    "summary": (_TEXT, []),
    "verdict": (_TEXT, []),
}


def prefix():
    """The folder with bin/, lib/ and share/ of a wheel; None where hooke is used from its sources or the system."""
    inside = pathlib.Path(__file__).parent / "prefix"
    return inside if inside.is_dir() else None


def _path():
    """The library that HOOKE_LIBRARY names, the wheel's, that of the sources' build, or the system's."""
    named, inside = os.environ.get("HOOKE_LIBRARY"), prefix()
    if named or inside:
        return named or str(inside / "lib" / "libhooke.so.0")
    built = pathlib.Path(__file__).resolve().parents[3] / "build" / "libhooke.so.0"
    return str(built) if built.exists() else "libhooke.so.0"


_loaded = None
_loading = threading.Lock()


def library():
    """The loaded library with the types of its functions."""
    global _loaded
    with _loading:
        if _loaded is None:
            try:
                loaded = ctypes.CDLL(_path())
            except OSError as error:
                raise ImportError(f"libhooke cannot be loaded: {error}; build it (make lib), or name it in HOOKE_LIBRARY") from None
            for name, (result, arguments) in _FUNCTIONS.items():
                function = getattr(loaded, "hooke_" + name)
                function.restype = result
                function.argtypes = [] if arguments is None else [_RUN, *arguments]
            _loaded = loaded
    return _loaded


class LibraryRun:
    """One run of libhooke: its functions without the prefix, bytes as text, and arrays in the order of ids."""

    def __init__(self):
        self._library, self._frame = library(), None
        self._run = self._library.hooke_new()
        if not self._run:
            raise MemoryError("no memory for a run")

    def __del__(self):
        if getattr(self, "_run", None):
            self._library.hooke_free(self._run)
            self._run = None

    def call(self, name, *arguments):
        """The function of that name with this run; texts go in and come out as str."""
        coded = [a.encode() if isinstance(a, str) else a for a in arguments]
        result = getattr(self._library, "hooke_" + name)(self._run, *coded)
        return result.decode("utf-8", "replace") if isinstance(result, bytes) else result

    def describe(self, parameters, options, on_frame):
        """Sets parameters, {name: value}, and options, {name: [value, ...]}; the status of the first that is wrong, or 0."""
        given = [("parameter", name, value) for name, value in parameters.items()]
        given += [("option", name, value) for name, values in options.items() for value in values]
        for kind, name, value in given:
            status = self.call(kind, name, value)
            if status:
                return status
        if on_frame:
            self._frame = _FRAME(lambda _run, _context: on_frame())
            return self.call("on_frame", self._frame, None)
        return 0

    def start(self, path, text):
        return self.call("open", path) if text is None else self.call("open_text", path, text)

    # ---- looking ----

    def energy(self):
        """J: kinetic, potential, work."""
        values = [ctypes.c_double() for _ in range(3)]
        self.call("energy", *(ctypes.byref(v) for v in values))
        return [v.value for v in values]

    def measures(self):
        values, name = {}, self.call("measure_name", 0)
        while name is not None:
            values[name] = self.call("measure", len(values))
            name = self.call("measure_name", len(values))
        return values

    def channels(self):
        names, name = [], self.call("channel_name", 0)
        while name is not None:
            names.append(name)
            name = self.call("channel_name", len(names))
        return names

    def blocks(self):
        """The state as {name: (address, numbers per particle, type)}. Where there is an "order", row order[k] is of the k-th id."""
        number, identity, found = ctypes.c_double, ctypes.c_uint32, {}
        blocks = (("positions", 3, number), ("velocities", 3, number), ("masses", 1, number), ("ids", 1, identity), ("order", 1, identity))
        for name, width, kind in blocks:
            address = self.call(name)
            if address:
                found[name] = (address, width, kind)
        for name in self.channels():
            width = ctypes.c_size_t()
            address = self.call("channel", name, ctypes.byref(width))
            found["channel " + name] = (address, width.value, number)
        return found
