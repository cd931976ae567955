"""A diagnosed joint in a simulation loop of your own: effects that MuJoCo does not have are stepped with it."""

import mujoco

import bench
from bench.assets import asset
from bench.effects.present import parse_effect
from bench.export.mjcf import single_joint

rig = bench.load_rig(asset("data", "rigs", "sh30701p.toml"))
hidden = [parse_effect("stribeck_friction:static_friction=0.17,stribeck_velocity=3")]
run = bench.simulate(rig, "identification", effects=hidden).trace
found = bench.diagnose(run, rig)

text, carried = single_joint(found.model, "elbow")  # an MJCF with this one joint, to attach to any body
print("\n".join(carried.lines))

model = mujoco.MjModel.from_xml_string(text)
data, effects = mujoco.MjData(model), bench.Effects(found.model, joint="elbow")
for torque in (0.12, 0.16, 0.2):  # N*m: the joint sticks until the torque exceeds its static friction
    mujoco.mj_resetData(model, data)
    while data.time < 0.2:
        data.ctrl[:] = torque
        effects.step(model, data)  # in the place of mujoco.mj_step(model, data)
    print(f"{torque} N*m: {data.qvel[0]:.4f} rad/s after {data.time:.1f} s")
