"""The process of one run: `python _worker.py COMMANDS REPORTS STATE`, three descriptors. The first line of COMMANDS is the job as
JSON; REPORTS gets a line for each frame and one at the end. STATE is memory shared with the caller: at a frame that it
waits for, and at the end, the blocks of the state one after another."""
import ctypes
import json
import mmap
import os
import sys
import threading

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))  # the package itself imports much that is not needed here
from _library import LibraryRun  # noqa: E402


class Worker:
    def __init__(self, commands, reports, state):
        self.commands, self.reports, self.state = os.fdopen(commands), os.fdopen(reports, "w"), state
        self.run, self.size, self.memory = None, 0, None
        self.go_on = threading.Semaphore(0)

    def listen(self):
        """In a thread of its own: a run is stopped within a step, also by the end of the caller."""
        for line in self.commands:
            if line.strip() == "stop":
                break
            self.go_on.release()
        self.run.call("stop")
        self.go_on.release()

    def report(self, **what):
        self.reports.write(json.dumps(what) + "\n")
        self.reports.flush()

    def share(self):
        """Copies the state; returns where its blocks are, {name: [offset, numbers per particle, type]}."""
        n, places, offset = self.run.call("count"), {}, 0
        blocks = self.run.blocks()
        for name, (_, width, kind) in blocks.items():
            places[name] = [offset, width, "<u4" if kind is ctypes.c_uint32 else "<f8"]
            offset += (n * width * ctypes.sizeof(kind) + 63) // 64 * 64
        if offset > self.size:  # births
            os.ftruncate(self.state, offset)
            self.memory = (ctypes.c_char * offset).from_buffer(mmap.mmap(self.state, offset))
            self.size = offset
        for name, (address, width, kind) in blocks.items():
            ctypes.memmove(ctypes.addressof(self.memory) + places[name][0], address, n * width * ctypes.sizeof(kind))
        return {"count": n, "places": places, "size": self.size}

    def frame(self, waited_for):
        what = {"time": self.run.call("time"), "measures": self.run.measures(), "energy": self.run.energy()}
        if waited_for:
            what.update(self.share())
        self.report(frame=what)
        if waited_for:
            self.go_on.acquire()

    def work(self):
        job = json.loads(self.commands.readline())
        try:
            self.run = LibraryRun()
        except ImportError as error:
            self.report(end={"status": 4, "error": str(error)})
            return
        threading.Thread(target=self.listen, daemon=True).start()
        status = self.run.describe(job["parameters"], job["options"], lambda: self.frame(job["waits"]))
        status = status or self.run.start(job["path"], job["text"]) or self.run.call("finish")
        end = {"status": status, "error": self.run.call("error") if status else "", "verdict": self.run.call("verdict")}
        summary = self.run.call("summary")
        if summary is not None:
            end.update(self.share(), summary=json.loads(summary), time=self.run.call("time"), energy=self.run.energy())
        self.report(end=end)


if __name__ == "__main__":
    Worker(*(int(word) for word in sys.argv[1:4])).work()
