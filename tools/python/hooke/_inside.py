"""A run in this process: nothing is copied, and a plugin that crashes takes the interpreter along."""
import contextlib
import ctypes
import json
import os
import signal
import threading

from . import _errors
from ._library import LibraryRun


@contextlib.contextmanager
def _stops_at_ctrl_c(run):
    """Python's own handler waits for the call in C to return, and what it raised in a callback would be lost there: meanwhile a
    thread hears of the signal and ends the run, and KeyboardInterrupt is raised behind it. Another handler stays."""
    own = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if threading.current_thread() is not threading.main_thread() or not own:
        yield
        return
    heard = []
    hears, says = os.pipe()
    os.set_blocking(says, False)

    def listen():
        for number in iter(lambda: os.read(hears, 1), b""):
            if number[0] == signal.SIGINT:
                heard.append(number)
                run.call("stop")

    thread = threading.Thread(target=listen, daemon=True)
    thread.start()
    before = signal.set_wakeup_fd(says, warn_on_full_buffer=False)
    signal.signal(signal.SIGINT, lambda _number, _frame: None)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.set_wakeup_fd(before)
        os.close(says)
        thread.join()
        os.close(hears)
    if heard:
        raise KeyboardInterrupt


class InsideRun:
    """The same as ProcessRun, for the calling thread."""

    def __init__(self, job, on_frame):
        self._job, self._on_frame, self._raised = job, on_frame, None
        try:
            self._run = LibraryRun()
        except ImportError as error:
            raise _errors.FileError(str(error)) from None

    def block(self, what, name):
        address, width, kind = self._run.blocks()[name]
        memory = (kind * (what["count"] * width)).from_address(address)
        memory.run = self._run  # what looks at the memory keeps it
        return memory, 0, width, "<u4" if kind is ctypes.c_uint32 else "<f8"

    def _figures(self):
        run = self._run
        return {"time": run.call("time"), "energy": run.energy(), "count": run.call("count"),
                "places": dict.fromkeys(run.blocks())}

    def _frame(self):
        try:
            if self._on_frame(self, {**self._figures(), "measures": self._run.measures()}) is False:
                self._run.call("stop")
        except BaseException as error:  # it may not pass through C
            self._raised = error
            self._run.call("stop")

    def finish(self):
        job, run = self._job, self._run
        with _stops_at_ctrl_c(run):
            status = run.describe(job["parameters"], job["options"], self._frame)
            status = status or run.start(job["path"], job["text"]) or run.call("finish")
        if self._raised is not None:
            raise self._raised
        end = {"status": status, "error": run.call("error") if status else "", "verdict": run.call("verdict")}
        summary = run.call("summary")
        if summary is not None:
            end.update(self._figures(), summary=json.loads(summary))
        return end
