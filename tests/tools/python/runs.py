"""The Python package hooke: runs in a process of their own and in this one, views, frames, errors, Ctrl-C, crashes, sweeps."""
import math
import os
import signal
import sys
import tempfile
import threading
import time
import unittest

import hooke

BALL = """
local z = param('z', 9, 'm', { min = 0 })
local scene = hooke.scene { duration = 1, fps = 10 }
scene:channel('heat', {})
scene:particle { mass = 2, position = { 0, 0, z }, velocity = { 1, 0, 0 }, heat = 7 }
scene:force('gravity', {})
scene:measure('z', function(s) return s:position(1)[3] end)
return scene
"""
ENDLESS = BALL.replace("duration = 1, fps = 10", "duration = 1e9, fps = 1, dt = 1e-4")


def flat(block):
    return block.ravel().tolist() if hasattr(block, "ravel") else list(block)


class Runs(unittest.TestCase):
    def test_both_kinds_of_run_give_the_same_bits(self):
        apart, inside = (hooke.Scene(text=BALL, z=10).run(in_process=where, until=0.5) for where in (False, True))
        for run in (apart, inside):
            self.assertEqual((run.verdict, run.count, run.time), ("ok", 1, 0.5))
            self.assertAlmostEqual(flat(run.positions)[2], 10 - 9.81 / 8, delta=1e-12)  # g t^2 / 2, exact for leapfrog
            self.assertEqual((flat(run.masses), flat(run.ids), flat(run.channel("heat"))), ([2], [1], [7]))
            self.assertEqual(len(run.measures["z"]), 6)  # frames at 0, 0.1 ... 0.5 s
        self.assertEqual(flat(apart.positions) + flat(apart.velocities), flat(inside.positions) + flat(inside.velocities))
        self.assertEqual(apart.energy, inside.energy)

    def test_frames_are_seen_and_false_stops(self):
        for inside in (False, True):
            seen = []

            def look(frame):
                seen.append((frame.time, flat(frame.positions)[0], frame.measures["z"]))
                return len(seen) < 4

            with self.assertRaises(hooke.Interrupted) as caught:
                hooke.Scene(text=BALL).run(on_frame=look, in_process=inside)
            self.assertEqual([t for t, _, _ in seen], [0, 0.1, 0.2, 3 / 10])
            self.assertTrue(all(abs(t - x) < 1e-12 for t, x, _ in seen))  # at 1 m/s
            self.assertEqual(caught.exception.run.verdict, "interrupted")

    def test_what_a_callback_raises_is_raised(self):
        for inside in (False, True):
            with self.assertRaises(ZeroDivisionError):
                hooke.Scene(text=BALL).run(on_frame=lambda frame: 1 / 0, in_process=inside)

    def test_arrays_cannot_be_written_and_outlive_the_run(self):
        block = hooke.Scene(text=BALL).run(in_process=True).positions
        self.assertAlmostEqual(flat(block)[0], 1, delta=1e-12)
        if hasattr(block, "flags"):
            self.assertFalse(block.flags.writeable)
            self.assertEqual(block.shape, (1, 3))


    def test_rows_are_in_the_order_of_ids_whatever_the_engines_is(self):
        places = "local place, n = {}, 4096\nfor k = 1, n do place[k] = { (k * 1237) % n, 0, 0 } end\n"  # neighbours are far apart
        body = """local of, edges = {}, {}
for k = 1, n do of[place[k][1]] = k end
for k = 1, n - 1 do edges[k] = { of[k - 1], of[k] } end
local scene = hooke.scene { duration = 0.01, dt = 0.01 }
scene:particles { positions = place, mass = 1 }
scene:force("springs", { edges = edges, k = 1 })
return scene
"""
        for inside in (False, True):
            run = hooke.Scene(text=places + body).run(in_process=inside, no_check=True)
            self.assertIn("order", run._what["places"])
            self.assertEqual(flat(run.ids), list(range(1, 4097)))
            self.assertEqual([round(x) for x in flat(run.positions)[::3]], [k * 1237 % 4096 for k in range(1, 4097)])


class Errors(unittest.TestCase):
    def refused(self, kind, sentence, *path, options=None, **scene):
        with self.assertRaises(kind) as caught:
            hooke.Scene(*path, **scene).run(**{"in_process": True, **(options or {})})
        self.assertIn(sentence, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))

    def test_the_engines_sentences(self):
        self.refused(hooke.FileError, "cannot read the scene no_such.lua", "no_such.lua")
        self.refused(hooke.ScriptError, "scene.lua:1", text="return 1 +")
        self.refused(hooke.ScriptError, "scene.lua:1", text="return 1 +", options={"in_process": False})
        self.refused(hooke.ParameterError, "did you mean '--accuracy'", options={"accurcy": 1}, text=BALL)
        self.refused(hooke.ParameterError, "-1 is below the minimum 0", text=BALL, z=-1)

    def test_what_is_no_value(self):
        with self.assertRaisesRegex(hooke.ParameterError, "z: a list is neither"):
            hooke.Scene(text=BALL, z=[1])
        for scene in ({"text": BALL, "z": "9\0"}, {"text": "return 1\0"}):  # it would be cut off in C
            with self.assertRaisesRegex(hooke.ParameterError, "no character 0"):
                hooke.Scene(**scene)
        with self.assertRaisesRegex(hooke.ParameterError, "a file or a text"):
            hooke.Scene()
        with self.assertRaisesRegex(hooke.ParameterError, "no channel 'cold': the scene has heat"):
            hooke.Scene(text=BALL).run(in_process=True).channel("cold")

    def test_a_library_or_program_that_is_missing_is_said(self):
        before, program = os.environ["HOOKE_LIBRARY"], os.environ["HOOKE"]
        run = hooke.Scene(text=BALL).run(in_process=True)
        os.environ["HOOKE"] = "/nowhere/hooke"
        os.environ["HOOKE_LIBRARY"] = "/nowhere/libhooke.so.0"  # this process has loaded it, or not
        try:
            with self.assertRaisesRegex(hooke.FileError, "libhooke cannot be loaded: .*make lib"):
                hooke.Scene(text=BALL).run()
            with self.assertRaisesRegex(hooke.FileError, "/nowhere/hooke, which makes pages, is not there"):
                run.page()
        finally:
            os.environ["HOOKE_LIBRARY"], os.environ["HOOKE"] = before, program

    def test_a_run_that_diverges_has_its_last_state(self):
        wild = BALL.replace("'gravity', {}", "'central', { strength = 1e9 }")
        with self.assertRaises(hooke.Diverged) as caught:
            hooke.Scene(text=wild).run(in_process=True, dt=0.1, integrator="euler", until=20)
        self.assertEqual(caught.exception.run.verdict, "diverged")

    def test_ctrl_c_ends_a_run_that_would_not_end(self):
        for inside in (False, True):
            threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
            with self.assertRaises(KeyboardInterrupt):
                hooke.Scene(text=ENDLESS).run(in_process=inside)
                time.sleep(5)  # the signal comes while the run is on its way, or here

    def test_a_crash_leaves_this_process_alone(self):
        def crash(frame):
            os.kill(frame._source._process.pid, signal.SIGSEGV)
            time.sleep(0.01)

        with self.assertRaisesRegex(hooke.Crashed, "ended by SIGSEGV after t = 0 s"):
            hooke.Scene(text=ENDLESS).run(on_frame=crash)


class Sweeps(unittest.TestCase):
    def test_ctrl_c_ends_a_sweep(self):
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            hooke.sweep(hooke.Scene(text=ENDLESS), [{"z": z} for z in range(1, 5)], processes=2)

    def test_a_sweep_keeps_the_order_and_the_failures(self):
        runs = hooke.sweep(hooke.Scene(text=BALL), [{"z": 5}, {"z": -1}, {"z": 6}], processes=2)
        self.assertEqual([math.floor(flat(runs[k].positions)[2] * 1000 + 0.5) for k in (0, 2)], [95, 1095])
        self.assertIsInstance(runs[1], hooke.ParameterError)
        again = hooke.sweep(hooke.Scene(text=BALL), [{}], with_=["force:gravity", "force:gravity"])  # three times g
        self.assertAlmostEqual(flat(again[0].positions)[2], 9 - 3 * 9.81 / 2, delta=1e-9)
        with self.assertRaisesRegex(hooke.ParameterError, "leave in_process out"):
            hooke.sweep("x.lua", [{}], in_process=True)


if __name__ == "__main__":
    os.chdir(tempfile.mkdtemp())
    unittest.main(argv=sys.argv[:1])
