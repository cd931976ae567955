"""A hundred copies of a diagnosed joint, stepped together with effects that MuJoCo does not have."""

import mujoco
import numpy as np
from mujoco.batch import Batch

import bench
from bench.assets import asset
from bench.effects.present import parse_effect
from bench.export.mjcf import single_joint

rig = bench.load_rig(asset("data", "rigs", "sh30701p.toml"))
hidden = [parse_effect("stribeck_friction:static_friction=0.17,stribeck_velocity=3")]
found = bench.diagnose(bench.simulate(rig, "identification", effects=hidden).trace, rig)

text, _ = single_joint(found.model, "elbow")
model = mujoco.MjModel.from_xml_string(text)
batch = Batch(model, 100)
copies = bench.Effects(found.model, joint="elbow").on(batch)

torque = np.linspace(0.1, 0.3, 100)[:, None]  # N*m, one for each copy
for _ in range(round(0.2 / model.opt.timestep)):
    batch.ctrl[:] = torque
    copies.step()  # in the place of batch.step()
moving = np.abs(batch.qvel[:, 0]) > 0.01
print(f"{moving.sum()} of 100 move; the weakest torque that moves one: {torque[moving].min():.3f} N*m")
