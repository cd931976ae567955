"""A whole arm by one command: what `bench robot` finds of six joints that each hide something else, and how it moves.

    python -m tests.studies.robot
    python -m tests.studies.robot --seed 3 --mjcf robosuite/models/assets/robots/ur5e/robot.xml --body wrist_3_link

The logs are of a UR5e by the Newton-Euler equations written out (`tests/joints/ur5e.py`): nothing of MuJoCo is in them.
One of them holds a payload that is sought. The model that comes back is let run free from the state that another log's
sensors have every second, driven by the torque in it; so is one of the true values.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
from mujoco.batch import Batch

import bench
from bench.effects.present import Present
from bench.export.mjcf import Armature, robot_with
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.model_file import StoredModel, load_joints
from bench.plant.robot import AddedBody
from tests.export.two_links import write_log
from tests.joints import ur5e

#: What the last link carries: kg, and its place in the link's frame - m.
PAYLOAD = (2.8, (0.03, 0.12, -0.05))
#: Logs in which models run free, by what their seeds are more: where speeds pass zero, each window is its own draw.
UNSEEN = (100, 200, 300)
#: Of the plain arm.
BODY = "link 6"


def measured(folder: Path, mjcf: Path | None = None, body: str = BODY, seed: int = 0, play: float = 0.0) -> dict:
    """All figures of one arm, in a folder that gets its files.

    Args:
        folder: an empty one.
        mjcf: of an arm with the same joints and links; the plain one where none is given.
        body: its last link.
        seed: of motion and noise.
        play: of the first joint's gear, in the place of what else it hides - rad.
    """
    if mjcf is None:
        mjcf = folder / "arm.xml"
        mjcf.write_text(ur5e.mjcf())
    hidden = (replace(ur5e.HIDDEN[0], effect="") if play else ur5e.HIDDEN[0], *ur5e.HIDDEN[1:])
    write_log(folder / "log.csv", ur5e.log(hidden, seed=seed, payload=PAYLOAD, play=play))
    began, before = time.monotonic(), os.times()
    command = ["robot", folder / "log.csv", "--mjcf", mjcf, "--payload", body, "--out", folder / "robot_id"]
    subprocess.run([sys.executable, "-m", "bench", *map(str, command)], check=True, stdout=subprocess.DEVNULL)
    after = os.times()
    spent = after.children_user + after.children_system - before.children_user - before.children_system
    found = json.loads((folder / "robot_id" / "robot.json").read_text())
    figures = {name: of_joint(found["joints"][name], own) for name, own in zip(ur5e.NAMES, hidden, strict=True)}
    payload, moved = found["payload"], None
    if payload is not None:
        centre = float(np.linalg.norm(np.subtract(payload["center_of_mass"]["value"], PAYLOAD[1])))
        moved = {"mass": payload["mass"]["value"] / PAYLOAD[0] - 1.0, "centre": centre}
    unseen = [ur5e.log(seed=seed + more, payload=PAYLOAD) for more in UNSEEN]
    return {
        "joints": figures,
        "payload": moved,
        "links": found["links"],
        "wall": time.monotonic() - began,
        "cpu": spent,
        "free": {
            "found": in_all(folder / "robot_id" / "robot_id.xml", models_found(folder), unseen),
            "true": in_all(with_truth(mjcf, folder / "true.xml", body), models_true(), unseen),
        },
    }


def of_joint(found: dict, own: ur5e.Hidden) -> dict:
    """Names, and how far off armature and friction are, of their true values; all quantities of what is named."""
    names = [effect["name"] for effect in found["effects"]]
    true = {
        "armature": own.armature,
        "viscous_friction_coefficient": own.viscous,
        "coulomb_friction_torque": own.coulomb,
    }
    parameters = found["parameters"]
    off = {
        name: parameters[name]["value"] / value - 1.0 if name in parameters else np.nan for name, value in true.items()
    }
    held = {
        name: parameters[name]["ci95"][0] <= value <= parameters[name]["ci95"][1]
        for name, value in true.items()
        if name in parameters
    }
    of = {"named": names, "hidden": [own.effect] if own.effect else [], "verdict": found["verdict"]}
    return of | {"off": off, "inside": held}


def models_found(folder: Path) -> dict[str, StoredModel]:
    """As the command wrote them."""
    return load_joints(folder / "robot_id" / "effects.toml")


def models_true() -> dict[str, StoredModel]:
    """Of the hidden values; inertia is the armature's, which is what a model puts onto a joint."""
    found = {}
    for name, own in zip(ur5e.NAMES, ur5e.HIDDEN, strict=True):
        effects = (Present.of(own.effect, own.values),) if own.effect else ()
        found[name] = StoredModel(name, AxisModel(AxisParameters(own.armature, own.viscous, own.coulomb), effects))
    return found


def with_truth(mjcf: Path, out: Path, body: str) -> Path:
    """An MJCF with the true values, and what its last link carries."""
    armature = {name: Armature(own.armature, "hidden") for name, own in zip(ur5e.NAMES, ur5e.HIDDEN, strict=True)}
    models = {name: (model, armature[name]) for name, model in models_true().items()}
    text, _ = robot_with(mjcf, models, out, [AddedBody(body, *PAYLOAD)])
    out.write_text(text)
    return out


def in_all(path: Path, models: dict[str, StoredModel], logs: list[dict]) -> list[float]:
    """RMS error of each joint over all logs - rad."""
    return np.sqrt(np.mean(np.square([free_running(path, models, columns) for columns in logs]), axis=0)).tolist()


def free_running(path: Path, models: dict[str, StoredModel], columns: dict, horizon: float = 1.0) -> list[float]:
    """RMS error of each joint's angle over windows that begin every second at what the sensors say - rad."""
    model = mujoco.MjModel.from_xml_path(str(path))
    at = columns["time [s]"]
    q, w, torque = (
        np.stack([columns[f"{name}.{signal}"] for name in ur5e.NAMES], axis=1)
        for signal in ("position [rad]", "velocity [rad/s]", "torque [N*m]")
    )
    stride = round((at[1] - at[0]) / model.opt.timestep)
    length = round(horizon / (at[1] - at[0]))
    starts = np.arange(0, at.size - length, length)
    batch = Batch(model, starts.size)
    dofs = [int(model.joint(name).dofadr[0]) for name in ur5e.NAMES]
    motors = [motor_of(model, name) for name in ur5e.NAMES]
    batch.qpos[:, dofs], batch.qvel[:, dofs] = q[starts], w[starts]
    copies = bench.Effects(models).on(batch)
    squares = np.zeros(len(dofs))
    for k in range(length * stride):
        moment = at[starts] + (k + 0.5) * model.opt.timestep
        for joint, motor in enumerate(motors):
            batch.ctrl[:, motor] = np.interp(moment, at, torque[:, joint])
        copies.step()
        if (k + 1) % stride == 0:
            squares += np.sum((batch.qpos[:, dofs] - q[starts + (k + 1) // stride]) ** 2, axis=0)
    return np.sqrt(squares / (length * starts.size)).tolist()


def motor_of(model: mujoco.MjModel, joint: str) -> int:
    """The actuator that drives a joint, apart from those that carry effects."""
    on = np.flatnonzero(model.actuator_trnid[:, 0] == model.joint(joint).id)
    return int(on[0])


def table(figures: dict) -> str:
    """For a person."""
    lines = ["joint                 hidden                    named                     J %    viscous % Coulomb %"]
    for name, one in figures["joints"].items():
        off = " ".join(f"{100.0 * value:8.2f}" for value in one["off"].values())
        lines.append(f"{name:21} {', '.join(one['hidden']):25} {', '.join(one['named']):25} {off}")
    if figures["payload"]:
        mass, centre = figures["payload"]["mass"], figures["payload"]["centre"]
        lines.append(f"payload: mass {100 * mass:.2f} % off, centre {1e3 * centre:.2f} mm")
    for kind, errors in figures["free"].items():
        lines.append(f"free-running over 1 s, {kind} model: " + " ".join(f"{1e3 * e:.3f}" for e in errors) + " mrad")
    ratio = np.linalg.norm(figures["free"]["found"]) / np.linalg.norm(figures["free"]["true"])
    lines.append(f"ratio {ratio:.2f}; {figures['wall']:.1f} s of wall, {figures['cpu']:.1f} s of CPU")
    return "\n".join(lines)


def main() -> None:
    """See the module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mjcf", type=Path, help="another MJCF of a UR5e whose joints have the same names")
    parser.add_argument("--body", default=BODY, help="its last link")
    parser.add_argument("--seed", type=int, default=0, help="of motion and noise")
    parser.add_argument(
        "--play", type=float, default=0.0, help="of the first joint's gear, instead of what else it hides - rad"
    )
    parser.add_argument("--out", type=Path, required=True, help="folder that gets logs, MJCFs and figures.json")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    figures = measured(given.out, given.mjcf, given.body, given.seed, given.play)
    (given.out / "figures.json").write_text(json.dumps(figures, indent=1))
    print(table(figures))


if __name__ == "__main__":
    main()
