"""Heaps of rigid boxes that are dropped, each turned its own way, on a floor, by `contact` on one thread: processor time of a
step in all and for a box, intersections, and the most by which the energy rose between frames, which is to be rounding.

A heap that has come down costs far more than one that begins to, so that time is not in proportion to its contacts. Of one
run each, 1/500 s a step, on a busy machine, 0 intersections in each that ended:

  boxes   until, s   processor s   ms a step   energy rose, J
     27        0.6         3.0          10         2e-12
     64        0.24        3.1          26         0
    125        0.2         1.5          15         0
    343        0.2         2.9          29         3e-12

Before what is solved together (cones/solid_program.h) began with the sliding of the impulses given and was accelerated, 64 boxes
took 7.8 s, 125 3.6 s, 343 7.0 s (until 0.2 s), 125 boxes until 0.5 s 159 s, and 1,000 did not end in 175 s until 0.256 s; these
last two were not measured since. Up to two fifths of the solutions of a heap that tumbles still stop short of the tolerance,
where impulses wander between contacts that lie nearly in one place, and sweeps take over from there.

  HK_BUILD=build python3 tests/bench/box_heaps.py [DURATION, s (0.16: the lowest layers land)]
"""
import json, os, resource, subprocess, sys, tempfile

hooke = os.path.join(os.path.abspath(os.environ.get("HK_BUILD", "build")), "hooke")
duration = float(sys.argv[1]) if len(sys.argv) > 1 else 0.16
SCENE = """
local n = param("n", 3, "boxes along an edge of the heap")
local scene = hooke.scene { duration = %g, fps = 25, dt = 1 / 500, integrator = "leapfrog" }
local a, apart = 0.1, 0.15
for k = 0, n - 1 do for j = 0, n - 1 do for i = 0, n - 1 do
  local turn = 0.03 * ((7 * i + 11 * j + 13 * k) %% 10)
  local b = scene:rigid { shape = "box", size = a, mass = 1, orientation = { turn, turn / 2, turn / 3 },
    position = { apart * (i - (n - 1) / 2), apart * (j - (n - 1) / 2), 0.12 + apart * k } }
  b:surface()
end end end
scene:body { shape = "box", size = { 20, 20, 0.2 }, position = { 0, 0, -0.1 } }
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:corrector("contact", { thickness = 2e-3, friction = 0.5 })
local last, rose = math.huge, 0
scene:on_frame(function(s) rose, last = math.max(rose, s:energy() - last), s:energy() end)
scene:measure("rose", function() return rose end)
return scene
""" % duration

for n in (3, 5, 8, 10):
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "heap.lua"), "w") as file:
            file.write(SCENE)
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        run = subprocess.run([hooke, "run", "heap.lua", f"n={n}", "--json", "--quiet", "--no-output", "--threads", "1"],
                             cwd=folder, capture_output=True, text=True)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    if run.returncode != 0:
        sys.exit(f"hooke ended with {run.returncode}: {run.stderr}{run.stdout[:300]}")
    found = json.loads(run.stdout)
    step = 1e3 * seconds / found["steps"]
    print(f"{n ** 3} boxes: {step:.2f} ms a step, {1e3 * step / n ** 3:.1f} us for a box; {found['contact']['intersections']} intersections, "
          f"energy rose by {found['measures']['rose']:.1e} J", flush=True)
