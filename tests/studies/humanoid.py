"""A humanoid of 29 joints on a stand, by MuJoCo's inverse dynamics: what one command takes of time and memory.

Legs of six joints, a waist of three and arms of seven. The motion of each joint is a sum of sines in closed form; the
torque of its links is that of `mj_inverse`, to which armature and friction are added by their equations. Some joints
hide cogging or Stribeck friction as well. Speeds and torques have noise.

    python -m tests.studies.humanoid --seconds 60 --joints 6 29

prints, for each number of joints, CPU time, time on the clock and memory at most, how often intervals of 95 % contain
armature and friction, and the effects that were found, missed and not there.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from pathlib import Path

import mujoco
import numpy as np

import bench
from tests.export.two_links import waves
from tests.studies.frame import cpu, table

RATE = 500.0
#: Noise of position - rad -, speed - rad/s - and torque, as a share of its RMS.
POSITION, SPEED, TORQUE = 1e-5, 2e-3, 1e-3
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


def mjcf(joints: int) -> str:
    """Of the first so many joints, on a pelvis that does not move."""
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


def hidden(rng: np.random.Generator, joints: int) -> dict[str, np.ndarray]:
    """What the joints have beyond their links (joints,) - SI; cogging and Stribeck friction in a quarter each."""
    coulomb = rng.uniform(0.2, 1.5, joints)
    kind = rng.permuted(np.arange(joints) % 4)
    return {
        "armature": rng.uniform(0.005, 0.04, joints),
        "viscous_friction_coefficient": rng.uniform(0.05, 0.5, joints),
        "coulomb_friction_torque": coulomb,
        "cogging_torque": np.where(kind == 0, 0.3 * coulomb, 0.0),
        "stribeck_friction": np.where(kind == 1, 0.5 * coulomb, 0.0),
    }


def write_log(path: Path, model: mujoco.MjModel, of: dict[str, np.ndarray], rng: np.random.Generator, n: int) -> None:
    """A log of so many samples, all joints moving."""
    t, data = np.arange(n) / RATE, mujoco.MjData(model)
    drawn = [
        waves(t, rng.uniform(0.05, 0.25, 4), rng.uniform(0.1, 1.5, 4), rng.uniform(0, 6.3, 4)) for _ in range(model.nv)
    ]
    q, w, a = (np.array([one[k] for one in drawn]).T for k in range(3))
    torque = np.empty_like(q)
    for k in range(n):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], w[k], a[k]
        mujoco.mj_inverse(model, data)
        torque[k] = data.qfrc_inverse
    dry = of["coulomb_friction_torque"] + of["stribeck_friction"] * np.exp(-np.abs(w) / 0.05)
    torque += of["armature"] * a + of["viscous_friction_coefficient"] * w + dry * np.sign(w)
    torque += of["cogging_torque"] * np.sin(12.0 * q)
    noisy = [
        q + POSITION * rng.standard_normal(q.shape),
        w + SPEED * rng.standard_normal(q.shape),
        torque + TORQUE * torque.std(axis=0) * rng.standard_normal(q.shape),
    ]
    units = {"position": "rad", "velocity": "rad/s", "torque": "N*m"}
    names = [f"{model.joint(k).name}.{one} [{unit}]" for one, unit in units.items() for k in range(model.nv)]
    header = ",".join(["time [s]", *names])
    np.savetxt(path, np.column_stack([t, *noisy]), "%.8g", ",", header=header, comments="")


def measured(joints: int, seconds: float, seed: int) -> tuple[str, ...]:
    """The row of a robot with so many joints."""
    rng = np.random.default_rng([seed, joints])
    of = hidden(rng, joints)
    with tempfile.TemporaryDirectory() as folder:
        robot, log = Path(folder) / "robot.xml", Path(folder) / "log.csv"
        robot.write_text(mjcf(joints), encoding="utf-8")
        write_log(log, mujoco.MjModel.from_xml_path(str(robot)), of, rng, round(seconds * RATE))
        begun, clock = cpu(), time.perf_counter()
        found = bench.robot(log, robot)
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
    parser.add_argument("--joints", type=int, nargs="+", default=[6, 29])
    parser.add_argument("--seconds", type=float, nargs="+", default=[60.0])
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rows = [measured(joints, seconds, options.seed) for seconds in options.seconds for joints in sorted(options.joints)]
    heads = ("joints", "s", "CPU, s", "clock, s", "MB of a process", "in the interval of 95 %", "effects", "not there")
    print(table(heads, rows))


if __name__ == "__main__":
    main()
