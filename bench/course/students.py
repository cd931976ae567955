"""Recordings for a class: each student's own axis and folder, and the truth of all in one sealed file elsewhere."""

from __future__ import annotations

import hashlib
import json
import shutil
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from bench.course.answers import MISTAKES, Worked
from bench.course.axis import KG_CM2, RPM, embedded, rotor_inertia
from bench.course.record import record
from bench.course.recordings import FASTEST, LabRecordings, read_truth
from bench.course.submission import FORM, form
from bench.errors import InputError
from bench.files import write_text
from bench.plant.axis_model import AxisParameters
from bench.plant.simulate import truth_path
from bench.rig.motor import catalogue_motor
from bench.rig.rig import Rig

SCHEMA = "bench.lab.class/1"
#: Ranges that students' axes are drawn from.
DIAMETER, THICKNESS = (0.130, 0.145), (5.5e-3, 7.5e-3)  # of the disk - m
BEYOND_THEORY = (0.10, 0.20)  # share of hub, coupling and bolts in the disk's theory
VISCOUS, COULOMB = (0.7e-3, 1.8e-3), (0.06, 0.11)  # N*m*s/rad, N*m
DATASHEET = (0.97, 1.03)  # factor on stall torque, peak torque and peak current
ROTOR = (0.8, 1.2)  # factor on its inertia
SPEEDS = (0.95, 1.05)  # factor on the speeds of the peak curves
VELOCITY_NOISE, CURRENT_NOISE = (1.0, 2.0), (3.0, 8.0)  # deg/s, mA


def record_class(
    folder: Path, students: int, seed: int, progress: Callable[[float], None] = lambda share: None
) -> list[Path]:
    """Simulate every student's axis and write folders `student-01`, ..., and the truth beside the folder of them all.

    Args:
        folder: of the class, new or empty.
        students: how many.
        seed: of everything drawn.
        progress: called with the share done.

    Returns:
        The students' folders, and the file of the truth.

    Raises:
        InputError: fewer than one student, or a folder that is not empty.
    """
    if students < 1:
        raise InputError("--students", f"found {students}", "allowed: 1 or more")
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(folder, "is there and not empty", "name a new folder for the class")
    folders, known = [], {}
    for number in range(1, students + 1):
        name = f"{number:02}"
        folders.append(folder / f"student-{name}")
        known[name] = _record_student(folders[-1], name, np.random.default_rng([seed, number]))
        progress(number / students)
    truth = folder.with_name(f"{folder.name}.truth.json")
    content = {"schema": SCHEMA, "seed": seed, "students": known}
    write_text(truth, json.dumps({**content, "seal": seal(content)}, indent=1) + "\n")
    truth.chmod(0o600)
    return [*folders, truth]


def seal(content: Mapping[str, Any]) -> str:
    """Checksum of a truth's content, to detect changes."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _record_student(folder: Path, name: str, random: np.random.Generator) -> dict[str, Any]:
    """Write one folder; returns its truth, the course's own answers, and the figures of every mistake."""
    table = draw_rig(random)
    rig = Rig.of(table)
    with tempfile.TemporaryDirectory() as temporary:
        paths = record(Path(temporary), int(random.integers(2**31)), rig=rig)
        truth = _truth(rig, read_truth(truth_path(Path(temporary) / f"{FASTEST}.trace"))["corner_speed"])
        for path in paths:
            if not path.name.endswith("truth.json"):
                target = folder / path.relative_to(temporary)
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(path, target)
    public = {key: value for key, value in table.items() if key != "simulation"}
    public["drive"] = {key: value for key, value in table["drive"].items() if key != "inertia_feedforward"}
    write_text(folder / "rig.toml", tomli_w.dumps({**public, "name": f"axis of student {name}"}))
    write_text(folder / FORM, form(name))
    worked = Worked.of(LabRecordings.in_folder(folder))
    mistakes = {mistake.name: [worked.answers(way) for way in mistake.ways] for mistake in MISTAKES}
    return {"truth": truth, "expected": worked.answers(), "mistakes": mistakes}


def draw_rig(random: np.random.Generator) -> dict[str, Any]:
    """An axis of its own as a rig file has it, with `[simulation]`."""
    table = embedded()
    diameter, thickness = random.uniform(*DIAMETER), random.uniform(*THICKNESS)
    load = {**table["load"], "outer_diameter": f"{1e3 * diameter:.1f} mm", "thickness": f"{1e3 * thickness:.2f} mm"}
    motor = {
        **table["motor"],
        "continuous_stall_torque": f"{1.4 * random.uniform(*DATASHEET):.3f} N*m",
        "peak_torque": f"{3.5 * random.uniform(*DATASHEET):.3f} N*m",
        "peak_current": f"{5.7 * random.uniform(*DATASHEET):.3f} A",
        "rotor_inertia": f"{0.25 * random.uniform(*ROTOR):.3f} kg*cm**2",
    }
    motor = motor_table(motor, random.uniform(*SPEEDS))
    bare = Rig.of({**table, "motor": motor, "load": load})
    theory = bare.load.disk_inertia if bare.load else None
    assert theory is not None, "the embedded rig has a disk"
    inertia = (rotor_inertia(bare) + theory * (1.0 + random.uniform(*BEYOND_THEORY))) * KG_CM2
    simulation = {
        **table["simulation"],
        "moment_of_inertia": f"{inertia:.4f} kg*cm**2",
        "viscous_friction_coefficient": f"{1e3 * random.uniform(*VISCOUS):.4f} mN*m*s/rad",
        "coulomb_friction": f"{1e3 * random.uniform(*COULOMB):.2f} mN*m",
        "velocity_noise": f"{random.uniform(*VELOCITY_NOISE):.2f} deg/s",
        "current_noise": f"{random.uniform(*CURRENT_NOISE):.2f} mA",
    }
    drive = {**table["drive"], "inertia_feedforward": f"{inertia:.4f} kg*cm**2"}
    return {**table, "motor": motor, "load": load, "drive": drive, "simulation": simulation}


def motor_table(motor: Mapping[str, Any], speeds: float) -> dict[str, Any]:
    """A motor table with its catalogue entry filled in, as a rig file's is when it is read; speeds times a factor."""
    entry = catalogue_motor(motor["model"], "embedded rig")
    curves = [
        {key: value if key == "mains_voltage" else _times(value, speeds) for key, value in curve.items()}
        for curve in entry["peak_curves"]
    ]
    return {**entry, **motor, "peak_curves": curves}


def _times(speed: str, factor: float) -> str:
    value, unit = speed.split()
    return f"{float(value) * factor:.0f} {unit}"


def _truth(rig: Rig, corner: float) -> dict[str, float]:
    """True values under the names of the form, where the simulation has them; corner - rad/s."""
    axis = AxisParameters.from_rig(rig)
    inertia, load = axis.inertia * KG_CM2, (axis.inertia - rotor_inertia(rig)) * KG_CM2
    return {
        "J": inertia,
        "J_load": load,
        "J_without_friction": inertia,
        "J_load_without_friction": load,
        "K_fric_w": axis.viscous_friction_coefficient,
        "K_fric_0": axis.coulomb_friction,
        "M_max": rig.motor.peak_torque or 0.0,
        "corner": corner * RPM,
    }
