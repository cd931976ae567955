"""`python in_mjlab.py ROBOT.xml ACTUATORS.py TORQUES.json`: the robot with these actuators, as mjlab compiles it."""

import json
import runpy
import sys
from pathlib import Path

import mujoco
from mjlab.entity import Entity, EntityArticulationInfoCfg, EntityCfg

robot, actuators, torques = sys.argv[1:]
entity = Entity(
    EntityCfg(
        spec_fn=lambda: mujoco.MjSpec.from_file(robot),
        articulation=EntityArticulationInfoCfg(actuators=runpy.run_path(actuators)["ACTUATORS"]),
    )
)
model = entity.spec.compile()
model.opt.timestep = 5e-4  # which mjlab takes from its simulation, not from the MJCF
data, found = mujoco.MjData(model), []
for inputs in json.loads(Path(torques).read_text()):
    data.ctrl[:] = inputs
    mujoco.mj_step(model, data)
    found.append(data.qvel.tolist())
print(json.dumps(found))
