"""Whole robots by MuJoCo's inverse dynamics: what one command finds, and what it takes of time and memory.

A humanoid of 29 joints on a stand, whose legs have six joints, the waist three and arms seven; and a desktop arm of six
hobby servos at 200 Hz, which have an encoder of 12 bit, no speed, and currents in coarse steps. The motion of each
joint is a sum of sines in closed form; the torque of its links is that of `mj_inverse`, to which armature and friction
are added by their equations. Some joints hide cogging or Stribeck friction as well.

    python -m tests.studies.whole_robots --seconds 60 --joints 6 29
    python -m tests.studies.whole_robots --robot desktop_arm --seconds 30 --joints 6 --seeds 1 2 3 4

prints, for each number of joints, CPU time, time on the clock and memory at most, how often intervals of 95 % contain
armature and friction, and the effects that were found, missed and not there.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

import bench
from tests.export.two_links import waves
from tests.studies.frame import cpu, table


@dataclass(frozen=True)
class Robot:
    """What a robot is like.

    Attributes:
        mjcf: of its first so many joints.
        rate: of its log - Hz.
        position, speed: noise - rad, rad/s -; a speed of inf is not recorded.
        torque: noise, as a share of the RMS torque.
        steps: of position and torque - rad, N*m -; 0 for none.
        armature, viscous, coulomb: bounds of what joints have - kg*m**2, N*m*s/rad, N*m.
        amplitude: bounds of each of four sines of a joint - rad.
        home: centre of the motion - rad.
        effects: cogging and Stribeck friction over Coulomb friction; speed of the latter - rad/s.
    """

    mjcf: Callable[[int], str]
    rate: float
    position: float
    speed: float
    torque: float
    steps: tuple[float, float]
    armature: tuple[float, float]
    viscous: tuple[float, float]
    coulomb: tuple[float, float]
    amplitude: tuple[float, float]
    home: tuple[float, ...] = (0.0,)
    effects: tuple[float, float, float] = (0.3, 0.5, 0.05)


#: Chains of joints: what they hang on, where, and for each joint its axis, the length of its link - m - and mass - kg.
LEG = (
    ("010", 0.02, 1.4),
    ("100", 0.10, 1.5),
    ("001", 0.20, 2.0),
    ("010", 0.30, 1.9),
    ("010", 0.03, 0.3),
    ("100", 0.05, 0.6),
)
WAIST = ("001", 0.02, 0.4), ("100", 0.02, 0.4), ("010", 0.15, 8.0)
ARM = (
    ("010", 0.03, 0.7), ("100", 0.05, 0.6), ("001", 0.15, 0.7), ("010", 0.10, 0.6),
    ("001", 0.05, 0.3), ("010", 0.04, 0.3), ("100", 0.05, 0.2),
)  # fmt: skip
CHAINS = {
    "left_leg": (LEG, "pelvis", 0.1, -1.0),
    "waist": (WAIST, "pelvis", 0.0, 1.0),
    "left_arm": (ARM, "waist_2", 0.2, -1.0),
    "right_arm": (ARM, "waist_2", -0.2, -1.0),
    "right_leg": (LEG, "pelvis", -0.1, -1.0),
}

#: Links of the desktop arm: axis, place on the one before - m -, mass - kg -, centre - m -, inertia - kg*m**2 -, near
#: those of a SO-ARM100 (google-deepmind/mujoco_menagerie, trs_so_arm100).
DESKTOP_ARM = (
    ([0, 0, 1], [0.0, 0.0, 0.05], 0.119, [0.0, 0.0, 0.03], [6e-5, 6e-5, 3e-5]),
    ([0, 1, 0], [0.0, 0.0, 0.06], 0.162, [0.003, 0.0, 0.07], [2.1e-4, 1.7e-4, 7e-5]),
    ([0, 1, 0], [0.0, 0.0, 0.116], 0.148, [0.003, 0.0, 0.077], [1.4e-4, 1.1e-4, 5e-5]),
    ([0, 1, 0], [0.0, 0.0, 0.135], 0.066, [0.0, 0.0, 0.035], [3.4e-5, 2.4e-5, 2e-5]),
    ([0, 0, 1], [0.0, 0.0, 0.06], 0.093, [0.005, 0.0, 0.028], [5e-5, 4.6e-5, 2.7e-5]),
    ([0, 1, 0], [0.0, 0.02, 0.024], 0.020, [0.0, 0.0, 0.03], [1.1e-5, 9e-6, 3e-6]),
)


def desktop_arm(joints: int) -> str:
    """MJCF of the first so many joints."""
    spec = mujoco.MjSpec()
    at = spec.worldbody
    for k, (axis, place, mass, centre, inertia) in enumerate(DESKTOP_ARM[:joints]):
        at = at.add_body(name=f"link_{k}", pos=place)
        at.add_joint(name=f"joint_{k}", axis=axis)
        at.mass, at.ipos, at.inertia, at.explicitinertial = mass, centre, inertia, True
    spec.compile()
    return spec.to_xml()


def humanoid(joints: int) -> str:
    """MJCF of the first so many joints, on a pelvis that does not move."""
    spec, left = mujoco.MjSpec(), joints
    spec.worldbody.add_body(name="pelvis", pos=[0.0, 0.0, 1.0])
    for chain, (parts, parent, aside, down) in CHAINS.items():
        at, offset = spec.body(parent), [0.0, aside, 0.0]
        for k, (axis, length, mass) in enumerate(parts):
            if not left or at is None:
                break
            at, left = at.add_body(name=f"{chain}_{k}", pos=offset), left - 1
            at.add_joint(name=f"{chain}_{k}", axis=[float(one) for one in axis])
            at.mass, at.ipos, at.explicitinertial = mass, [0.01, 0.0, 0.5 * down * length], True
            at.inertia = [mass * (length**2 / 12.0 + 4e-4)] * 2 + [mass * 4e-4]
            offset = [0.0, 0.0, down * length]
    spec.compile()
    return spec.to_xml()


ROBOTS = {
    "humanoid": Robot(
        humanoid, 500.0, 1e-5, 2e-3, 1e-3, (0.0, 0.0), (0.005, 0.04), (0.05, 0.5), (0.2, 1.5), (0.05, 0.25)
    ),
    "desktop_arm": Robot(
        desktop_arm, 200.0, 1e-4, np.inf, 0.01, (2.0 * np.pi / 2**12, 0.0065), (0.01, 0.03), (0.02, 0.08), (0.05, 0.12),
        (0.1, 0.35), (0.0, 0.8, 0.6, 0.5, 0.0, 0.5), (0.4, 0.5, 0.1),
    ),
}  # fmt: skip


def hidden(robot: Robot, rng: np.random.Generator, joints: int) -> dict[str, np.ndarray]:
    """What the joints have beyond their links (joints,) - SI; cogging and Stribeck friction in a quarter each."""
    coulomb = rng.uniform(*robot.coulomb, joints)
    kind = rng.permuted(np.arange(joints) % 4)
    cogging, stribeck, _ = robot.effects
    return {
        "armature": rng.uniform(*robot.armature, joints),
        "viscous_friction_coefficient": rng.uniform(*robot.viscous, joints),
        "coulomb_friction_torque": coulomb,
        "cogging_torque": np.where(kind == 0, cogging * coulomb, 0.0),
        "stribeck_friction": np.where(kind == 1, stribeck * coulomb, 0.0),
    }


def write_log(
    path: Path, robot: Robot, model: mujoco.MjModel, of: dict[str, np.ndarray], rng: np.random.Generator, n: int
) -> None:
    """A log of so many samples, all joints moving."""
    t, data = np.arange(n) / robot.rate, mujoco.MjData(model)
    drawn = [
        waves(t, rng.uniform(*robot.amplitude, 4), rng.uniform(0.1, 1.5, 4), rng.uniform(0, 6.3, 4))
        for _ in range(model.nv)
    ]
    q, w, a = (np.array([one[k] for one in drawn]).T for k in range(3))
    q += np.resize(robot.home, model.nv)
    torque = np.empty_like(q)
    for k in range(n):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], w[k], a[k]
        mujoco.mj_inverse(model, data)
        torque[k] = data.qfrc_inverse
    dry = of["coulomb_friction_torque"] + of["stribeck_friction"] * np.exp(-np.abs(w) / robot.effects[2])
    torque += of["armature"] * a + of["viscous_friction_coefficient"] * w + dry * np.sign(w)
    torque += of["cogging_torque"] * np.sin(12.0 * q)
    measured = {
        "position [rad]": in_steps(q + robot.position * rng.standard_normal(q.shape), robot.steps[0]),
        "velocity [rad/s]": w + robot.speed * rng.standard_normal(q.shape),
        "torque [N*m]": in_steps(
            torque + robot.torque * torque.std(axis=0) * rng.standard_normal(q.shape), robot.steps[1]
        ),
    }
    recorded = {name: values for name, values in measured.items() if np.isfinite(values).all()}
    names = ["time [s]", *(f"{model.joint(k).name}.{one}" for one in recorded for k in range(model.nv))]
    np.savetxt(path, np.column_stack([t, *recorded.values()]), "%.8g", ",", header=",".join(names), comments="")


def in_steps(values: np.ndarray, step: float) -> np.ndarray:
    """Values as a sensor of a resolution gives them; as they are where it is 0."""
    return step * np.round(values / step) if step else values


def measured(robot: Robot, joints: int, seconds: float, seed: int) -> tuple[str, ...]:
    """The row of a robot with so many joints."""
    rng = np.random.default_rng([seed, joints])
    of = hidden(robot, rng, joints)
    with tempfile.TemporaryDirectory() as folder:
        mjcf, log = Path(folder) / "robot.xml", Path(folder) / "log.csv"
        mjcf.write_text(robot.mjcf(joints), encoding="utf-8")
        write_log(log, robot, mujoco.MjModel.from_xml_path(str(mjcf)), of, rng, round(seconds * robot.rate))
        begun, clock = cpu(), time.perf_counter()
        found = bench.robot(log, mjcf)
        spent, clock = cpu() - begun, time.perf_counter() - clock
    inside = asked = 0
    named, missed, false = 0, 0, list[str]()
    for k, (name, joint) in enumerate(found.joints.items()):
        effects = {one.name for one in joint.diagnosis.effects} if joint.diagnosis is not None else set[str]()
        truth = {one for one in ("cogging_torque", "stribeck_friction") if of[one][k]}
        named, missed = named + len(truth & effects), missed + len(truth - effects)
        false += [f"{name} {one}" for one in effects - truth]
        for one in ("armature", "viscous_friction_coefficient", "coulomb_friction_torque"):
            if one in joint.parameters:
                low, high = joint.parameters[one].ci95
                inside, asked = inside + bool(low <= of[one][k] <= high), asked + 1
    memory = max(resource.getrusage(whose).ru_maxrss for whose in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return (
        str(joints), f"{seconds:g}", f"{spent:.0f}", f"{clock:.0f}", f"{memory / 1024:.0f}",
        f"{inside} of {asked}, {3 * joints} wanted", f"{named} of {named + missed}", ", ".join(false) or "none",
    )  # fmt: skip


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robot", choices=ROBOTS, default="humanoid")
    parser.add_argument("--joints", type=int, nargs="+", default=[6, 29])
    parser.add_argument("--seconds", type=float, nargs="+", default=[60.0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[1])
    options = parser.parse_args()
    rows = [
        measured(ROBOTS[options.robot], joints, seconds, seed)
        for seconds in options.seconds
        for joints in sorted(options.joints)
        for seed in options.seeds
    ]
    heads = ("joints", "s", "CPU, s", "clock, s", "MB of a process", "in the interval of 95 %", "effects", "not there")
    print(table(heads, rows))


if __name__ == "__main__":
    main()
