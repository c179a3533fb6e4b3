"""Pyramids of rigid boxes in hooke's contact beside MuJoCo's (Todorov, Erez and Tassa 2012), one thread each: processor time
of a step, how far and how fast boxes that should lie still move, intersections.

  HK_BUILD=build python3 tests/bench/stacks.py          (MuJoCo: pip install mujoco)

MuJoCo's contact is soft: its boxes sink until it bears them. A step of hooke's is the difference of a run of 60 and of
one of 10 steps, so that what a start takes is not in it.
"""
import json, os, resource, subprocess, sys, tempfile, time

os.environ["OMP_NUM_THREADS"] = "1"
try:
    import mujoco
except ImportError:
    print("skipped: MuJoCo is not installed, so there is nothing to compare with; pip install mujoco")
    sys.exit(0)

hooke = os.path.join(os.path.abspath(os.environ.get("HK_BUILD", "build")), "hooke")
side, thickness, mass, mu, h = 0.1, 2e-3, 1, 0.5, 2e-3


def places(layers, gap):
    return [((j + k / 2) * 1.05 * side, 0, (side + gap) * k + (side + gap) / 2)
            for k in range(layers) for j in range(layers - k)]


def scene(layers, steps):
    boxes = "\n".join(f"box({x!r}, {z!r})" for x, _, z in places(layers, thickness))
    return f"""
local scene = hooke.scene {{ duration = {steps * h}, fps = {0.1 / h}, dt = {h}, integrator = "leapfrog" }}
local list, from = {{}}, {{}}
local function box(x, z)
  list[#list + 1] = scene:rigid {{ shape = "box", size = {side}, mass = {mass}, position = {{ x, 0, z }} }}
  list[#list]:surface()
  from[#list] = {{ x, 0, z }}
end
{boxes}
scene:body {{ shape = "box", size = {{ 4, 2, 0.2 }}, position = {{ 0, 0, -0.1 }} }}
scene:force("gravity", {{ g = {{ 0, 0, -9.81 }} }})
scene:corrector("contact", {{ thickness = {thickness}, friction = {mu} }})
local function most(f)
  return function(s)
    local m = 0
    for k, b in ipairs(list) do for c = 1, 3 do m = math.max(m, math.abs(f(b, s, k)[c])) end end
    return m
  end
end
scene:measure("way", most(function(b, s, k)
  local x = b:position(s)
  return {{ x[1] - from[k][1], x[2], x[3] - from[k][3] }}
end))
scene:measure("speed", most(function(b, s) return b:velocity(s) end))
return scene
"""


def run_hooke(layers, steps):
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "stack.lua"), "w") as file:
            file.write(scene(layers, steps))
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        run = subprocess.run([hooke, "run", "stack.lua", "--json", "--quiet", "--no-output", "--threads", "1"],
                             cwd=folder, capture_output=True, text=True)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    if run.returncode != 0:
        sys.exit(f"hooke ended with {run.returncode}: {run.stderr}{run.stdout[:300]}")
    return seconds, json.loads(run.stdout)


def run_mujoco(layers, steps):
    half = side / 2
    boxes = "".join(f'<body pos="{x} {y} {z}"><freejoint/><geom type="box" size="{half} {half} {half}" mass="{mass}" '
                    f'friction="{mu} 0 0"/></body>' for x, y, z in places(layers, 0))
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{h}" cone="elliptic"/><size memory="200M"/><worldbody>'
        f'<geom type="plane" size="5 5 .1" friction="{mu} 0 0"/>{boxes}</worldbody></mujoco>')
    data = mujoco.MjData(model)
    begin = time.process_time()
    for _ in range(steps):
        mujoco.mj_step(model, data)
    seconds = time.process_time() - begin
    way = max(abs(q - p) for k, at in enumerate(places(layers, 0)) for q, p in zip(data.qpos[7 * k:7 * k + 3], at))
    return seconds / steps, way, max(abs(v) for v in data.qvel)


for layers in (3, 6, 10):
    short, _ = run_hooke(layers, 10)
    long, result = run_hooke(layers, 60)
    found = result["measures"]
    step, way, speed = run_mujoco(layers, 60)
    print(f"{layers * (layers + 1) // 2} boxes: hooke {1e3 * (long - short) / 50:.2f} ms a step, off by {found['way']:.1e} m, "
          f"{found['speed']:.1e} m/s; MuJoCo {1e3 * step:.2f} ms, {way:.1e} m, {speed:.1e} m/s", flush=True)
