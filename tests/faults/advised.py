"""Commands whose messages advise something, and the files they need."""

import numpy as np

from tests.hostile import RIG, TABLE, columns, csv_of

#: A joint that carries a link, with a second joint behind it.
ROBOT = """<mujoco><compiler angle="radian"/><worldbody><body><joint name="shoulder" axis="0 1 0"/>
<geom type="capsule" size="0.02" fromto="0 0 0 0 0 0.3" mass="0.5"/>
<body pos="0 0 0.3"><joint name="elbow" axis="0 1 0"/>
<geom type="capsule" size="0.02" fromto="0 0 0 0 0 0.2" mass="0.2"/>
</body></body></worldbody></mujoco>
"""


def headed(head):
    return csv_of(*columns(), head=head)


def disturbed(weight=0.0, beat=0.0, push=0.0):
    """The plain axis with a weight, a torque in time, and one along its motion - A."""
    time, velocity, current = columns()
    angle = 6.25 * (1.0 - np.cos(8.0 * time)) + 20.0 / 31.0 * (1.0 - np.cos(31.0 * time))
    more = weight * np.sin(angle) + beat * np.sin(19.0 * time)
    return csv_of(time, velocity, current + more + push * np.sign(velocity))


def two_axes():
    """The plain axis, and one that moves half as far."""
    time, velocity, current = columns()
    rows = zip(time.tolist(), velocity.tolist(), current.tolist(), strict=True)
    head = "time [s],A.velocity [rad/s],A.current [A],B.velocity [rad/s],B.current [A]"
    return "\n".join([head, *(f"{t!r},{w!r},{i!r},{w / 2!r},{i / 2!r}" for t, w, i in rows)]) + "\n"


def steady(speed):
    """The plain axis at one speed - rad/s."""
    time = 1e-3 * np.arange(200)
    rng = np.random.default_rng([int(100 * abs(speed)), speed > 0])
    torque = 8e-4 * speed + 0.06 * np.sign(speed) + 2e-3 * rng.normal(size=time.size)
    return csv_of(time, speed + 0.03 * rng.normal(size=time.size), torque / 0.8)


#: Recordings at steady speeds, by name.
SPEEDS = {f"at{k}.csv": steady(w) for k, w in enumerate(np.outer((-1, 1), np.geomspace(0.5, 60, 8)).ravel().tolist())}
#: Files by name: text.
FILES = {
    "log.csv": TABLE,
    "rig.toml": RIG,
    "robot.xml": ROBOT,
    "legged.xml": ROBOT.replace(
        "<worldbody>", '<worldbody><body name="trunk"><freejoint/><geom size="0.1" mass="1"/>'
    ).replace("</worldbody>", "</body></worldbody>"),
    "joint_log.csv": csv_of(*columns(), head="time [s],elbow.velocity [rad/s],elbow.torque [N*m]"),
    "no_time.csv": "\n".join(",".join(row.split(",")[1:]) for row in TABLE.splitlines()),
    "no_effort.csv": "\n".join(",".join(row.split(",")[:2]) for row in TABLE.splitlines()),
    "per_second.csv": headed("time [s],velocity [1/s],current [A]"),
    "two_axes.csv": two_axes(),
    "twice.csv": headed("time [s],velocity [rad/s],velocity [rad/s]"),
    "no_rotor.toml": RIG.replace('rotor_inertia = "2 kg*cm**2"', ""),
    "manifest.csv": "file,rig,axis,time\nlog.csv,rig.toml,a,2026-01-01\n",
    "pendulum.csv": "file,rig,axis,time\nswing.csv,rig.toml,a,2026-01-01\n",
    "swing.csv": disturbed(weight=1.0),
    "weight.csv": disturbed(weight=3.0),
    "beaten.csv": disturbed(beat=1.7),
    "beaten_weight.csv": disturbed(weight=3.0, beat=4.5),
    "pushed.csv": disturbed(push=-0.5),
    "refused.csv": "file,rig,axis,time\nno_effort.csv,rig.toml,a,2026-01-01\nlog.csv,rig.toml,b,2026-01-01\n",
    "checked.csv": "file,rig,axis,time\nbare.csv,rig.toml,a,2026-01-01\n",
    "bare.csv": headed("time,velocity,current"),
    "motion.csv": TABLE,
    "harder.csv": TABLE,
    **SPEEDS,
    "slow.toml": RIG + '[trace]\nsample_period = "2 ms"\n',
}

#: Commands that write further files.
MADE = [
    "bench diagnose log.csv --rig no_rotor.toml --out found",
    "bench diagnose log.csv --out amperes",
    "bench check --simulated found/model.toml --baseline model_baseline.toml --update",
]

#: Each leads to a message that advises something.
CASES = [
    "bench identify",
    "bench check log.csv",
    "bench chek log.csv",
    "bench identify no_time.csv",
    "bench identify no_effort.csv --rig rig.toml",
    "bench identify per_second.csv",
    "bench identify per_second.csv --rig rig.toml",
    "bench identify no_time.csv --rig rig.toml",
    "bench identify two_axes.csv",
    "bench identify twice.csv --rig rig.toml",
    "bench identify log.csv",
    "bench identify log.csv --rig slow.toml",
    "bench diagnose log.csv --rig rig.toml --without coging_torque",
    "bench check log.csv --rig rig.toml --baseline axis.toml",
    "bench check log.csv --rig rig.toml --baseline model_baseline.toml",
    "bench identify log.csv --mjcf robot.xml --joint shoulder --joint elbow",
    "bench identify log.csv --mjcf robot.xml --joint elbo",
    "bench export found/model.toml --out joint.xml",
    "bench export amperes/model.toml --snippet --out joint.xml",
    "bench replay found/model.toml log.csv --out replay.csv",
    "bench export found/model.toml --mjcf robot.xml --joint elbow --armature motor --out joint.xml",
    "bench export joints.toml --to mjcf --out joint.xml",
    "bench export joints.toml --mjcf robot.xml --joint elbow --out robot_id.urdf",
    "bench robot joint_log.csv --mjcf legged.xml --out legged",
    "bench export joints.toml --to mjlab --out actuators.py --with-assets",
    "bench fleet pendulum.csv --out fleet",
    "bench fleet pendulum.csv --out fleet --diagnose",
    "bench fleet manifest.csv --out fleet",
    "bench fleet refused.csv --out fleet",
    "bench fleet checked.csv --out fleet",
    "bench fleet manifest.csv --out fleet --deadline 0.1",
    "bench simulate sh30701p --profile fast_reversals --out run.csv --report run.html",
    "bench simulate sh30701p --profile fast_reversals --out run.csv --effect unbalance:amplitude=0.3 --report run.html",
    f"bench friction {' '.join(SPEEDS)} --rig rig.toml",
    f"bench friction {' '.join(SPEEDS)} --rig sh30701p",
    "bench replay found/model.toml log.csv --rig rig.toml --report replay.html",
    "bench replay found/model.toml swing.csv --rig rig.toml --page moving.html",
    "bench replay found/model.toml --rig sh30701p --profile fast_reversals --page moving.html",
    "bench inspect log.csv --rig rig.toml",
    "bench inspect two_axes.csv",
    "bench limits log.csv --rig rig.toml",
    "bench identify log.csv --rig rig.toml --max-size 1kB",
    "bench identify swing.csv --rig rig.toml",
    "bench identify weight.csv --rig rig.toml",
    "bench inspect beaten.csv --rig rig.toml --json -",
    "bench inspect beaten_weight.csv --rig rig.toml --json -",
    "bench identify pushed.csv --rig rig.toml",
    "bench list effects coging_torque",
    "bench list rigs sh30701",
    "bench list effects --out list.toml",
    "bench rigs",
    "bench export found/model.toml --to drive --out tables",
]
