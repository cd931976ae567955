"""`python in_newton.py ROBOT.xml JOINTS.py TORQUES.json`: the robot with these joints, in Newton's solver of MuJoCo."""

import json
import runpy
import sys
from pathlib import Path

import newton
import numpy as np

robot, joints, torques = sys.argv[1:]
builder = newton.ModelBuilder()
builder.add_mjcf(robot)
runpy.run_path(joints)["onto"](builder)
model = builder.finalize(device="cpu")
solver = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=True, disable_contacts=True)
before, after, control = model.state(), model.state(), model.control()
found = []
for inputs in json.loads(Path(torques).read_text()):
    control.joint_f.assign(np.array(inputs, dtype=np.float32))
    solver.step(before, after, control, None, 5e-4)
    before, after = after, before
    found.append(before.joint_qd.numpy().tolist())
print(json.dumps(found))
