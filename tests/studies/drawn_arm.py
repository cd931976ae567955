"""An arm whose joints hide drawn effects, and what `bench robot` finds of each: names, armature, friction, intervals.

    python -m tests.studies.drawn_arm --seeds 1 2 3 --out drawn

The arm is the UR5e of `tests/joints/ur5e.py`: its motion is given in closed form, its torque by Newton-Euler, and what
a joint hides is added to that. An elastic joint's motor is ahead of its link by the links' torque over the stiffness,
so that all is exact without an integrator. A torque that is reported 5 ms early is a dead time, not an effect. Effects
without a name in the catalogue are not drawn.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from scipy.interpolate import make_interp_spline

from tests.export.two_links import write_log
from tests.joints import ur5e
from tests.studies.frame import table

PERIOD, DURATION, DELAY = 2e-3, 20.0, 5e-3
#: What a joint may hide: with the names that report it.
KINDS = {
    "nothing": (),
    "stribeck": ("stribeck_friction",),
    "delay": (),
    "cogging": ("cogging_torque",),
    "gearloss": ("load_dependent_friction",),
    "spring": ("torsion_spring", "torque_offset"),
    "elastic": ("elastic_coupling",),
}
#: Armature, viscous and Coulomb friction of shoulder, upper arm, elbow and three wrists, about which values are drawn.
USUAL = ((0.8, 6.0, 5.0), (0.9, 7.0, 6.0), (0.8, 5.0, 4.0), (0.12, 1.2, 1.4), (0.11, 1.1, 1.2), (0.10, 0.9, 1.0))


def drawn(seed: int) -> tuple[dict, list[dict]]:
    """Columns of a log, and what each joint hides: its kind, armature, viscous and Coulomb friction."""
    rng = np.random.default_rng(1000 + seed)
    time, q, w, a = ur5e.motion(DURATION + 0.1, PERIOD, seed)
    rest, hidden = ur5e.asked(q, w, a), []
    of_joint = rng.permutation([*KINDS])[:6]
    motor = {}
    for k, (name, kind) in enumerate(zip(ur5e.NAMES, of_joint.tolist(), strict=True)):
        armature, viscous, coulomb = (value * rng.uniform(0.7, 1.4) for value in USUAL[k])
        angle, speed, acceleration = q[:, k], w[:, k], a[:, k]
        if kind == "elastic":
            own = ur5e.asked(q, 0.0 * w, a * (np.arange(6) == k))[:, k] - ur5e.asked(q, 0.0 * w, 0.0 * a)[:, k]
            turning = np.abs(a[:, k]) > 0.1
            inertia = float(np.median(own[turning] / a[turning, k]))
            stiffness = inertia * (2.0 * np.pi * rng.uniform(8.0, 12.0)) ** 2
            ahead = make_interp_spline(time, angle + rest[:, k] / stiffness, k=7)
            angle, speed, acceleration = (ahead(time, nu) for nu in range(3))
        sign = np.sign(speed)
        torque = rest[:, k] + armature * acceleration + viscous * speed + coulomb * sign
        if kind == "stribeck":
            torque = torque + rng.uniform(0.4, 0.8) * coulomb * np.exp(-((speed / rng.uniform(0.05, 0.15)) ** 2)) * sign
        elif kind == "cogging":
            wave = np.sin(rng.integers(6, 16) * angle + rng.uniform(0.0, 2.0 * np.pi))
            torque = torque + rng.uniform(0.3, 0.6) * coulomb * wave
        elif kind == "gearloss":
            torque = torque / (1.0 - rng.uniform(0.06, 0.15) * np.sign(torque) * sign)
        elif kind == "spring":
            middle = float(np.median(angle)) + rng.uniform(-0.3, 0.3)
            torque = torque + rng.uniform(0.8, 2.0) * coulomb * (angle - middle)
        elif kind == "delay":
            smooth = make_interp_spline(time, torque - coulomb * sign)(time + DELAY)
            torque = smooth + coulomb * np.sign(np.interp(time + DELAY, time, speed))
        hidden.append({"kind": kind, "armature": armature, "viscous": viscous, "coulomb": coulomb})
        motor[name] = angle, speed, torque
    kept = time < DURATION
    columns = {"time [s]": time[kept]}
    for k, (name, values) in enumerate(motor.items()):
        loud = (2e-5, 1e-3, 0.05 if k < 3 else 0.02)
        signals = ("position [rad]", "velocity [rad/s]", "torque [N*m]")
        for signal, exact, error in zip(signals, values, loud, strict=True):
            columns[f"{name}.{signal}"] = exact[kept] + error * rng.standard_normal(int(kept.sum()))
    return columns, hidden


def found(seed: int, folder: Path) -> list[dict]:
    """A row for each joint."""
    folder.mkdir(parents=True, exist_ok=True)
    columns, hidden = drawn(seed)
    (folder / "arm.xml").write_text(ur5e.mjcf())
    write_log(folder / "log.csv", columns)
    line = ["robot", folder / "log.csv", "--mjcf", folder / "arm.xml", "--out", folder / "robot_id"]
    subprocess.run([sys.executable, "-m", "bench", *map(str, line)], check=True, stdout=subprocess.DEVNULL)
    joints = json.loads((folder / "robot_id" / "robot.json").read_text())["joints"]
    return [scored(seed, joints[name], name, own) for name, own in zip(ur5e.NAMES, hidden, strict=True)]


def scored(seed: int, joint: dict, name: str, own: dict) -> dict:
    """Whether the effect is named and nothing else, and how far off values are, in shares and in half widths."""
    named, right = [effect["name"] for effect in joint["effects"]], KINDS[own["kind"]]
    row = {"seed": seed, "joint": name, "hidden": own["kind"], "named": " ".join(named), "verdict": joint["verdict"]}
    row["missed"] = bool(right) and not set(right) & set(named)
    row["false"] = " ".join(one for one in named if one not in right)
    late = joint.get("dead_time")
    row["delay"] = "" if late is None else f"{1e3 * late['delay']['value']:.2f} ms"
    parameters = joint["parameters"]
    terms = ("armature", "viscous_friction_coefficient", "coulomb_friction_torque")
    for key, term in zip(("armature", "viscous", "coulomb"), terms, strict=True):
        one = parameters.get(term)
        row[f"{key} %"] = "" if one is None else f"{100.0 * (one['value'] / own[key] - 1.0):.2f}"
        row[f"{key} inside"] = "" if one is None else one["ci95"][0] <= own[key] <= one["ci95"][1]
    return row


def main() -> None:
    """See the module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--out", type=Path, required=True, help="folder that gets logs and results")
    given = parser.parse_args()
    rows = [row for seed in given.seeds for row in found(seed, given.out / f"{seed}")]
    print(table([*rows[0]], (row.values() for row in rows)))


if __name__ == "__main__":
    main()
