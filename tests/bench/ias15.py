"""hooke's methods beside IAS15 of REBOUND (Rein and Spiegel 2015) on orbits and encounters whose ends are known: the error
and the time of each. A program of hooke's is a whole run without its check; both times are the least of some runs.

  HK_BUILD=build python3 tests/bench/ias15.py          (REBOUND: pip install rebound)

Measured on two cores that others shared, REBOUND 5.2.2: see the table of the commit that changes a method.
"""
import json, math, os, subprocess, sys, tempfile, time

try:
    import rebound
except ImportError:
    print("skipped: REBOUND is not installed, so there is nothing to compare with; pip install rebound")
    sys.exit(0)

REPEATS = 3
hooke = os.path.join(os.path.abspath(os.environ.get("HK_BUILD", "build")), "hooke")


def kepler(e, periods):
    """A planet of no mass to speak of, from its pericentre, for whole periods."""
    bodies = [(1, (0, 0, 0), (0, 0, 0)), (1e-30, (1 - e, 0, 0), (0, math.sqrt((1 + e) / (1 - e)), 0))]
    return f"Kepler, e = {e}, {periods} periods", 1, 2 * math.pi * periods, bodies, [None, (1 - e, 0, 0)]


# Burrau 1913; the end by Taylor's method of order 30 with 39 digits, whose energy is off by 1.4e-30.
pythagorean = ("Pythagorean, t = 70", 1, 70,
               [(3, (1, 3, 0), (0, 0, 0)), (4, (-2, -1, 0), (0, 0, 0)), (5, (1, -1, 0), (0, 0, 0))],
               [(6.933463599011887, 20.261804305951714, 0), (-2.0030060026059841, -6.8724634358245448, 0),
                (-2.5576733573223451, -6.6591118349113926, 0)])

# Hairer, Lubich and Wanner, Geometric Numerical Integration, I.2.4; the end is that of tests/support/nbody_scenes.c.
planets = ("outer planets, 200,000 days", 2.95912208286e-4, 200000, [
    (1.00000597682, (0, 0, 0), (0, 0, 0)),
    (0.000954786104043, (-3.5023653, -3.8169847, -1.5507963), (0.00565429, -0.00412490, -0.00190589)),
    (0.000285583733151, (9.0755314, -3.0458353, -1.6483708), (0.00168318, 0.00483525, 0.00192462)),
    (0.0000437273164546, (8.3101420, -16.2901086, -7.2521278), (0.00354178, 0.00137102, 0.00055029)),
    (0.0000517759138449, (11.4707666, -25.7294829, -10.8169456), (0.00288930, 0.00114527, 0.00039677)),
    (1 / 1.3e8, (-15.5387357, -25.2225594, -3.1902382), (0.00276725, -0.00170702, -0.00136504))],
    [(1.23584254235461, -0.48994382114427, -0.24610536181432), (2.61107957011286, -5.07952549678799, -2.24472067785306),
     (-7.66913624739131, -4.05205224548783, -1.33111566971138), (-5.82474394984774, 15.33717375357252, 6.78246340991761),
     (20.66398024751502, 20.58295604245987, 7.89479541474820), (36.56695069882260, -13.76768440125963, -15.04346922182326)])


def error(places, known):
    """RMS over the bodies whose ends are known."""
    squares = [sum((a - b) ** 2 for a, b in zip(p, k)) for p, k in zip(places, known) if k]
    return math.sqrt(sum(squares) / len(squares))


def with_rebound(problem):
    _, G, end, bodies, known = problem
    best = math.inf
    for _ in range(REPEATS):
        s = rebound.Simulation()
        s.integrator, s.G = "ias15", G
        for m, x, v in bodies:
            s.add(m=m, x=x[0], y=x[1], z=x[2], vx=v[0], vy=v[1], vz=v[2])
        begin = time.perf_counter()
        s.integrate(end)
        best = min(best, time.perf_counter() - begin)
    return error([(p.x, p.y, p.z) for p in s.particles], known), best


def with_hooke(problem, method, options):
    _, G, end, bodies, known = problem
    lines = [f"local scene = hooke.scene {{ duration = {end!r}, fps = {1 / end!r}, integrator = '{method}' }}"]
    for m, x, v in bodies:
        at, speed = ("{ " + ", ".join(map(repr, p)) + " }" for p in (x, v))
        lines.append(f"scene:particle {{ position = {at}, velocity = {speed}, mass = {m!r} }}")
    lines.append(f"scene:force('nbody', {{ G = {G!r} }})")
    for k in range(len(bodies)):
        for c in range(3):
            lines.append(f"scene:measure('x{k}{c}', function(s) return s:position({k + 1})[{c + 1}] end)")
    best = math.inf
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "scene.lua"), "w") as f:
            f.write("\n".join(lines) + "\nreturn scene\n")
        for _ in range(REPEATS):
            told = subprocess.run([hooke, "run", "scene.lua", "--json", "--quiet", "--no-output", "--threads", "1"] + options,
                                  cwd=folder, capture_output=True, text=True).stdout
            found = json.loads(told)
            best = min(best, found["step_wall_s"])
    ends = found["measures"]
    return error([[ends[f"x{k}{c}"] for c in range(3)] for k in range(len(bodies))], known), best


methods = [("gauss_radau", []), ("dop853", ["--tol", "1e-13"]), ("dopri5", ["--tol", "1e-13"])]
print(f"{'':30s} {'IAS15':>20s}" + "".join(f" {name + ' ' + ' '.join(o):>24s}" for name, o in methods))
for problem in [kepler(0.9, 100), kepler(0.99, 100), pythagorean, planets]:
    cells = [with_rebound(problem)] + [with_hooke(problem, name, o) for name, o in methods]
    text = ["%.1e in %6.3f s" % cell for cell in cells]
    print(f"{problem[0]:30s} {text[0]:>20s}" + "".join(f" {t:>24s}" for t in text[1:]), flush=True)
