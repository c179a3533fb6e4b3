"""Cart and pole by the least effort (Kelly, SIAM Review 59, 2017, section 6): `hooke optimise --way transcription` beside CasADi with
IPOPT on the same transcription, of 100 intervals, each a step of rk4 with a control that is linear within it, from the same guess:
the run without control. J, iterations and processor time of both sides (without the import of CasADi), each of its own process.

  HK_BUILD=build python3 tests/bench/casadi_cart_pole.py [INTERVALS (100)]        pip install casadi
"""
import json, os, resource, subprocess, sys, tempfile

hooke = os.path.join(os.path.abspath(os.environ.get("HK_BUILD", "build")), "hooke")
intervals = int(sys.argv[1]) if len(sys.argv) > 1 else 100
try:
    import casadi
except ImportError:
    print("casadi_cart_pole: left out, Python has no module casadi: pip install casadi")
    sys.exit(0)
import time

REFERENCE = 57.9447803, 58.8076675  # N^2 s: both good optima, by Pontryagin's equations to 1e-9 (continuous controls)
m1, m2, length, g, duration = 1, 0.3, 0.5, 9.81, 2
SCENE = """
local m1, m2, l, g, n = %g, %g, %g, %g, %d
local scene = hooke.scene { duration = %g, fps = %.17g, integrator = "rk4", dt = %.17g }
local push = scene:control("push", { knots = n + 1, help = "N" })
local p = scene:particle { position = { 0, 0, 0 } }
scene:force("field", { f = function(t, _, q, _, _, w)
  local u, s, c = push(t), math.sin(q), math.cos(q)
  local d = m1 + m2 * s * s
  return (l * m2 * s * w * w + u + m2 * g * c * s) / d, -(l * m2 * c * s * w * w + u * c + (m1 + m2) * g * s) / (l * d), 0
end })
scene:goal { particle = p, position = { 1, math.pi, 0 }, velocity = { 0, 0, 0 } }
return scene
""" % (m1, m2, length, g, intervals, duration, intervals / duration, duration / intervals)


def by_hooke():
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "cart_pole.lua"), "w") as file:
            file.write(SCENE)
        before, begun = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime, time.perf_counter()
        run = subprocess.run([hooke, "optimise", "cart_pole.lua", "--way", "transcription", "--json", "--quiet"], cwd=folder,
                             capture_output=True, text=True)
        wall = time.perf_counter() - begun
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    if not run.stdout.startswith("{"):
        sys.exit(f"hooke ended with {run.returncode}: {run.stderr}{run.stdout[:300]}")
    best = json.loads(run.stdout)["optima"][0]
    return best["cost"], best["iterations"], seconds, wall, best["ended"]


def by_casadi():
    h, n = duration / intervals, intervals
    y, a, b = casadi.SX.sym("y", 4), casadi.SX.sym("a"), casadi.SX.sym("b")

    def rate(y, u):
        q, w = y[1], y[3]
        s, c = casadi.sin(q), casadi.cos(q)
        d = m1 + m2 * s * s
        return casadi.vertcat(y[2:], (length * m2 * s * w * w + u + m2 * g * c * s) / d,
                              -(length * m2 * c * s * w * w + u * c + (m1 + m2) * g * s) / (length * d))

    middle = (a + b) / 2
    k1 = rate(y, a)
    k2 = rate(y + h / 2 * k1, middle)
    k3 = rate(y + h / 2 * k2, middle)
    k4 = rate(y + h * k3, b)
    step = casadi.Function("step", [y, a, b], [y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])
    before, begun = time.process_time(), time.perf_counter()
    Y, u = casadi.MX.sym("Y", 4, n + 1), casadi.MX.sym("u", n + 1)
    cost = h / 3 * casadi.sum1(u[:-1] ** 2 + u[:-1] * u[1:] + u[1:] ** 2)
    gaps = casadi.vec(step.map(n)(Y[:, :-1], u[:-1].T, u[1:].T) - Y[:, 1:])
    ends = casadi.vertcat(Y[:, 0], Y[:, n] - casadi.DM([1, casadi.pi, 0, 0]))
    problem = {"x": casadi.vertcat(casadi.vec(Y), u), "f": cost, "g": casadi.vertcat(gaps, ends)}
    solver = casadi.nlpsol("solver", "ipopt", problem, {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes", "ipopt.tol": 1e-10})
    found = solver(x0=0, lbg=0, ubg=0)  # hanging at rest is the run without control
    seconds, wall = time.process_time() - before, time.perf_counter() - begun
    return float(found["f"]), solver.stats()["iter_count"], seconds, wall, solver.stats()["return_status"]


sides = {"hooke": by_hooke(), "CasADi with IPOPT": by_casadi()}
for name, (cost, iterations, seconds, wall, ended) in sides.items():
    near = min(REFERENCE, key=lambda reference: abs(reference - cost))
    print(f"{name:18s} J = {cost:.8f} N^2 s ({cost / near - 1:+.1e} of {near}), {iterations} iterations, {seconds:.2f} s of a processor, "
          f"{wall:.2f} s by the clock, {ended}")
(ours, _, mine, _, _), (theirs, _, its, _, _) = sides.values()
print(f"J differs by {abs(ours - theirs) / theirs:.1e} of it; {mine / its:.1f} times the processor time of CasADi with IPOPT")
