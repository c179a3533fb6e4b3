"""The chain of tests/bench/joints.c in MuJoCo (Todorov, Erez and Tassa 2012): processor time of a rod and step, one thread.

  python3 tests/bench/joints.py          (MuJoCo: pip install mujoco)

MuJoCo's coordinates are the angles of the hinges. Its Euler has order 1, hooke's leapfrog 2.
"""
import os, sys, time

os.environ["OMP_NUM_THREADS"] = "1"
try:
    import mujoco
except ImportError:
    print("skipped: MuJoCo is not installed, so there is nothing to compare with; pip install mujoco")
    sys.exit(0)

RUNS, ROD_STEPS = 5, 20000


def chain(rods):
    body = "".join(f"""<body pos="{0.1 if k else 0} 0 0"><joint type="hinge" axis="0 1 0"/>
      <geom type="box" size="0.05 0.01 0.01" pos="0.05 0 0" mass="0.1" contype="0" conaffinity="0"/>""" for k in range(rods))
    return f"""<mujoco><option timestep="0.0005" gravity="0 0 -9.81" integrator="Euler"/>
      <worldbody>{body}{"</body>" * rods}</worldbody></mujoco>"""


print("us a rod and step, MuJoCo", mujoco.__version__)
for rods in (10, 25, 50, 100, 200, 400):
    model = mujoco.MjModel.from_xml_string(chain(rods))
    data, steps, least = mujoco.MjData(model), max(ROD_STEPS // rods, 20), float("inf")
    for _ in range(RUNS):
        mujoco.mj_resetData(model, data)
        begin = time.process_time()
        for _ in range(steps):
            mujoco.mj_step(model, data)
        least = min(least, time.process_time() - begin)
    print(f"{rods:4d} rods {1e6 * least / steps / rods:8.2f}")
