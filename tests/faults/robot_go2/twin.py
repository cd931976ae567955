"""Two slow joints of a legged robot on a stand, whose speeds are noisier than their accelerations are large."""

import numpy as np

LINK = 0.02
#: Armature, damping, frictionloss, amplitude of cogging 14 a turn.
JOINTS = {"hip": (0.02, 0.4, 0.4, 0.0), "calf": (0.03, 0.3, 0.45, 0.4)}
MJCF = """<mujoco><worldbody><body name="trunk">{free}<inertial pos="0 0 0" mass="5" diaginertia=".1 .1 .1"/>
<body name="a"><joint name="hip" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="{i} {i} {i}"/></body>
<body name="b"><joint name="calf" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="{i} {i} {i}"/></body>
</body></worldbody>{key}</mujoco>"""


def write(folder):
    rng, time = np.random.default_rng(3), 2e-3 * np.arange(10000)
    columns, names = [time], ["time"]
    for turn, (joint, (armature, damping, friction, cogging)) in enumerate(JOINTS.items()):
        omega, amplitude = np.array([[0.9, 6.1, 11.3, 17.9], [0.4, 0.2, 0.1, 0.03]])[:, :, None]
        phase = np.array([0.4, 1.3, 2.2, 0.1])[:, None] + turn
        angle = omega * time + phase
        speed, acceleration = (amplitude * np.sin(angle)).sum(axis=0), (amplitude * omega * np.cos(angle)).sum(axis=0)
        position = (-amplitude / omega * np.cos(angle)).sum(axis=0)
        torque = (LINK + armature) * acceleration + damping * speed + friction * np.sign(speed)
        torque += cogging * np.sin(14.0 * position + 1.0) + 0.01 * rng.normal(size=time.size)
        noise = 0.01 * rng.normal(size=time.size)
        # the drive answers noise of the speed with torque that hardly moves the joint
        step = 2.0 * np.pi / 2**14
        columns += [step * np.round(position / step), speed + noise, torque - 0.5 * noise]
        names += [f"{joint}.position [rad]", f"{joint}.velocity [rad/s]", f"{joint}.torque [N*m]"]
    np.savetxt(folder / "log.csv.gz", np.column_stack(columns), "%.7g", ",", header=",".join(names), comments="")
    key = '<keyframe><key name="home" qpos="0 0 .3 1 0 0 0 0 0"/></keyframe>'
    (folder / "robot.xml").write_text(MJCF.format(free="", i=LINK, key=""))
    (folder / "floating.xml").write_text(MJCF.format(free="<freejoint/>", i=LINK, key=key))
