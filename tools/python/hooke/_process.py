"""A run in a process of its own: what a plugin does there, a crash too, does not touch this interpreter."""
import json
import mmap
import os
import signal
import subprocess
import sys

from . import _errors

_PATIENCE = 10  # s, for a run that was asked to stop


class ProcessRun:
    """Starts the worker at once; `finish` returns what it says at the end."""

    def __init__(self, job, on_frame):
        self._on_frame, self._time, self._memory = on_frame, None, None
        read_commands, commands = os.pipe()
        reports, write_reports = os.pipe()
        self._state = os.memfd_create("hooke", os.MFD_CLOEXEC)
        theirs = (read_commands, write_reports, self._state)
        worker = os.path.join(os.path.dirname(os.path.abspath(__file__)), "_worker.py")
        self._process = subprocess.Popen(  # Ctrl-C is the caller's, who asks for an orderly end
            [sys.executable, "-I", "-S", worker, *map(str, theirs)], pass_fds=theirs, stdin=subprocess.DEVNULL, start_new_session=True)
        os.close(read_commands)
        os.close(write_reports)
        self._commands, self._reports = os.fdopen(commands, "w"), os.fdopen(reports)
        self._say(json.dumps(job))

    def _say(self, line):
        try:
            self._commands.write(line + "\n")
            self._commands.flush()
        except (BrokenPipeError, ValueError):
            pass  # the process has ended; what it reported says why

    def stop(self):
        """The run ends at its next step; any thread may say so."""
        self._say("stop")

    def block(self, what, name):
        """The array of that name as (memory, offset, numbers per particle, type)."""
        if self._memory is None or len(self._memory) < what["size"]:
            self._memory = mmap.mmap(self._state, what["size"], prot=mmap.PROT_READ)
        return (self._memory, *what["places"][name])

    def finish(self):
        try:
            for line in self._reports:
                report = json.loads(line)
                if "end" in report:
                    self._process.wait()
                    return report["end"]
                self._frame(report["frame"])
        except BaseException:
            self._abandon()
            raise
        raise self._crash()

    def _frame(self, frame):
        self._time = frame["time"]
        go_on = self._on_frame(self, frame)
        if "places" in frame:
            self._say("stop" if go_on is False else "go on")

    def _abandon(self):
        self._say("stop")
        self._commands.close()
        try:
            self._reports.read()  # to its end
            self._process.wait(_PATIENCE)
        except (subprocess.TimeoutExpired, KeyboardInterrupt):
            self._process.kill()
            self._process.wait()

    def _crash(self):
        code = self._process.wait()
        how = f"by {signal.Signals(-code).name}" if code < 0 else f"with code {code}"
        when = "before its first frame" if self._time is None else f"after t = {self._time:g} s"
        return _errors.Crashed(f"the process of the run ended {how} {when}: a plugin has crashed or ended it; `hooke run` names it")

    def __del__(self):
        for end in (getattr(self, "_commands", None), getattr(self, "_reports", None)):
            try:
                if end:
                    end.close()
            except OSError:
                pass
        if getattr(self, "_state", None) is not None:
            os.close(self._state)
