"""Scenes and their runs."""
import array
import concurrent.futures
import os
import re

from . import _errors, _page
from ._inside import InsideRun
from ._process import ProcessRun


def _word(name, value):
    """A value as the command line has it."""
    if hasattr(value, "item"):  # a number of numpy
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if not isinstance(value, (str, int, float)):
        raise _errors.ParameterError(f"{name}: a {type(value).__name__} is neither a number, a text nor a truth")
    return _text(name, str(value))


def _text(name, text):
    if "\0" in text:
        raise _errors.ParameterError(f"{name}: a text has no character 0, which would end it for the engine")
    return text


def _options(given):
    """Keywords as options of `hooke run`: no_check=True is the flag --no-check, None leaves one out, with_=[...] repeats --with."""
    options = {}
    for name, value in given.items():
        if value is None or value is False:
            continue
        values = value if isinstance(value, (list, tuple)) else [value]
        options[name.rstrip("_").replace("_", "-")] = ["" if v is True else _word(name, v) for v in values]
    return options


def _as_keywords(text):
    """A sentence with options of the command line as what run() takes in their stead: --dt 1e-4 is dt=1e-4."""
    text = re.sub(r"--(dt|tol|accuracy) ([\d.][\d.e+-]*)", r"\1=\2", text)
    return re.sub(r"--(integrator|solver) (\w+)", r'\1="\2"', text)


def _as_array(memory, offset, width, kind, count):
    """A view, n x width or n, that cannot be written to; a memoryview of all numbers where numpy is missing."""
    try:
        import numpy
    except ImportError:
        length = count * width * int(kind[-1])
        return memoryview(memory).cast("B")[offset:offset + length].cast({"<f8": "d", "<u4": "I"}[kind]).toreadonly()
    numbers = numpy.frombuffer(memory, dtype=kind, count=count * width, offset=offset)
    numbers.flags.writeable = False
    return numbers if width == 1 else numbers.reshape(count, width)


def _in_order(rows, order, count):
    """A copy of the rows in the order of ids."""
    if not isinstance(rows, memoryview):
        return rows[order]
    width = len(rows) // count
    return memoryview(array.array(rows.format, (rows[width * k + c] for k in order for c in range(width)))).toreadonly()


class State:
    """The particles at one moment, rows in the order of ids: a view, or a copy where the engine has them in another order."""

    def __init__(self, source, what):
        self._source, self._what = source, what
        self.time = what["time"]  #: s
        self.count = what.get("count", 0)
        self.energy = dict(zip(("kinetic", "potential", "work"), what["energy"]))  #: J

    def _block(self, name):
        rows, order = (_as_array(*self._source.block(self._what, key), self.count) if key in self._what["places"] else None
                       for key in (name, "order"))
        return rows if order is None else _in_order(rows, order, self.count)

    @property
    def positions(self):
        """n x 3, m."""
        return self._block("positions")

    @property
    def velocities(self):
        """n x 3, m/s."""
        return self._block("velocities")

    @property
    def masses(self):
        """n, kg."""
        return self._block("masses")

    @property
    def ids(self):
        """n, from 1: what scripts call the particles."""
        return self._block("ids")

    @property
    def channels(self):
        return [name[len("channel "):] for name in self._what["places"] if name.startswith("channel ")]

    def channel(self, name):
        """n, or n x its size, in the channel's unit."""
        if name not in self.channels:
            raise _errors.ParameterError(f"there is no channel '{name}': the scene has {', '.join(self.channels) or 'none'}")
        return self._block("channel " + name)


class Frame(State):
    """What on_frame gets: valid until it returns; copy what is to stay."""

    def __init__(self, source, what):
        super().__init__(source, what)
        self.measures = what["measures"]


class Run(State):
    """A run that is over: its last state, measures and verdict."""

    def __init__(self, scene, source, end, table, options):
        super().__init__(source, end)
        self.scene, self._table, self._options = scene, table, options
        self.verdict = end["verdict"]  #: ok, inaccurate, diverged or interrupted
        self.summary = end["summary"]  #: the figures, as `hooke run --json` prints them
        self.reason = _as_keywords(self.summary.get("reason") or "")  #: why the verdict is not ok; what to give to run()
        self.warnings = self.summary.get("warnings") or []

    @property
    def measures(self):
        """Those of the scene at its frames: a DataFrame over time where pandas is there, or else a dict of lists with "t"."""
        try:
            import pandas
        except ImportError:
            return {name: list(column) for name, column in self._table.items()}
        return pandas.DataFrame(self._table).set_index("t")

    def plot(self, names=None, axes=None):
        """Measures over time, by matplotlib: these, or all; eight lines with names, the rest grey. Gives the axes."""
        from . import _plot

        return _plot.plot(self, names, axes)

    def page(self, path=None):
        """The scene as a page to play, turn and share, by `hooke view`, which runs it again; a notebook shows it."""
        return _page.make(self.scene, self._options, path)

    def __repr__(self):
        return f"<hooke.Run of {self.scene.path}: {self.verdict} at {self.time:g} s, {self.count} particles>"


class Scene:
    """A scene's script, in a file or as `text`, with values of its parameters."""

    def __init__(self, path=None, /, *, text=None, **parameters):
        if path is None and text is None:
            raise _errors.ParameterError("a scene has a file or a text: hooke.Scene(\"cloth.lua\"), hooke.Scene(text=\"...\")")
        self.path = _text("the path", os.fspath(path)) if path is not None else "scene.lua"
        self.text = text if text is None else _text("text", text)
        self.parameters = {name: _word(name, value) for name, value in parameters.items()}

    def run(self, *, on_frame=None, in_process=False, **options):
        """Runs to the end and judges. Options are those of `hooke run` (until, accuracy, dt, integrator, threads, trust, out ...).

        on_frame(frame) is called at each frame; False stops the run, which then raises Interrupted. `in_process` copies
        nothing and starts no process, but a plugin that crashes takes the interpreter along."""
        return self._run(InsideRun if in_process else ProcessRun, _options(options), on_frame, lambda source: None)

    def _run(self, kind, options, on_frame, begun):
        """begun(source) is told of the run before it takes steps."""
        table, waits = {"t": []}, on_frame is not None

        def frame(source, what):
            table["t"].append(what["time"])
            for name, value in what["measures"].items():
                table.setdefault(name, []).append(value)
            return on_frame(Frame(source, what)) if waits else None

        job = {"path": self.path, "text": self.text, "parameters": self.parameters, "options": options, "waits": waits}
        source = kind(job, frame)
        begun(source)
        end = source.finish()
        run = Run(self, source, end, table, options) if "summary" in end else None
        if end["status"]:
            error = _errors.of_status(end["status"], end["error"])
            error.run = run
            raise error
        return run

    def __repr__(self):
        return f"<hooke.Scene {self.path} {self.parameters}>"


def sweep(scene, cases, *, processes=None, **options):
    """Runs of the scene (a path or a Scene) with each of the parameters in `cases`, dicts, in processes beside each other, one
    thread each unless `threads` says more. Returns a list in that order, of runs or, where one failed, of its exception."""
    scene = scene if isinstance(scene, Scene) else Scene(scene)
    if options.pop("in_process", False):
        raise _errors.ParameterError("a sweep runs in processes of their own: leave in_process out")
    options = _options({"threads": 1, **options})
    sources = []

    def run(case):
        try:
            one = Scene(scene.path, text=scene.text, **{**scene.parameters, **case})
            return one._run(ProcessRun, options, None, sources.append)
        except (_errors.Error, MemoryError) as error:
            return error

    with concurrent.futures.ThreadPoolExecutor(processes or os.cpu_count() or 1) as pool:
        runs = [pool.submit(run, case) for case in cases]
        try:
            return [one.result() for one in runs]
        except BaseException:  # Ctrl-C: none begins any more, and those under way end at their next step
            for one in runs:
                one.cancel()
            for source in sources:
                source.stop()
            raise
