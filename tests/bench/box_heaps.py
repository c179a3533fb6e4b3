"""Heaps of rigid boxes that are dropped, each turned its own way, on a floor, by `contact` on one thread: processor time of a
step in all and for a box, intersections, and the most by which the energy rose between frames, which is to be rounding.

A heap that has come down costs far more than one that begins to, so that time is not in proportion to its contacts. Of one
run each, 1/500 s a step, on a busy machine, 0 intersections in each that ended:

  boxes   until, s   processor s   ms a step   energy rose, J    MB
     27        0.2         1.2          12         0              8
    125        0.2         3.6          36         0             15
    343        0.2         7.0          70         0             22
     27        1           7.6          15         1.6e-5
     64        0.24        7.8          65         0
    125        0.5       159           636         0             24
  1,000        0.256     175                       (not ended)   62

What is solved together (cones/solid_program.h) gives up in a heap that tumbles: its programs for the sliding converge to the
tolerance by a factor of 0.2 to 0.8 each, and sweeps take over. To let it go on as long as a program halves what is left made
64 boxes dearer, not cheaper (10.8 s for 7.8 s).

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
