"""Recordings for a class: each student's own axis and folder, and the truth of all in one sealed file elsewhere."""

from __future__ import annotations

import hashlib
import json
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from bench.course.answers import ASKED, Material, answers
from bench.course.mistakes import MISTAKES
from bench.course.record import record
from bench.course.recordings import Recordings
from bench.course.sources import embedded
from bench.course.t06_inertia import KG_CM2
from bench.errors import InputError
from bench.files import write_text
from bench.rig.catalogue import catalogue_motor
from bench.rig.rig import Rig

SCHEMA, FORM = "bench.lab.class/1", "answers.csv"
#: Ranges that students' axes are drawn from.
DIAMETER, THICKNESS = (0.130, 0.145), (5.5e-3, 7.5e-3)  # of the disk - m
BEYOND_THEORY = (0.10, 0.20)  # share of hub, coupling and bolts in the disk's theory
VISCOUS, COULOMB = (0.7e-3, 1.8e-3), (0.06, 0.11)  # N*m*s/rad, N*m
DATASHEET = (0.97, 1.03)  # factor on stall torque, peak torque and peak current
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
        own = folder / f"student-{name}"
        known[name] = _record_student(own, name, np.random.default_rng([seed, number]))
        folders.append(own)
        progress(number / students)
    truth = folder.with_name(f"{folder.name}.truth.json")
    content = {"schema": SCHEMA, "seed": seed, "students": known}
    write_text(truth, json.dumps({**content, "seal": seal(content)}, indent=1) + "\n")
    truth.chmod(0o600)
    return [*folders, truth]


def seal(content: dict[str, Any]) -> str:
    """Checksum of a truth's content, to detect changes."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _record_student(folder: Path, name: str, random: np.random.Generator) -> dict[str, Any]:
    """Write one folder; returns its truth, the course's own answers, and the figures of every mistake."""
    table = draw_rig(random)
    public = {key: value for key, value in table.items() if key != "simulation"}
    public["drive"] = {key: value for key, value in table["drive"].items() if key != "inertia_feedforward"}
    with tempfile.TemporaryDirectory() as temporary:
        paths = record(Path(temporary), int(random.integers(2**31)), rig=Rig.of(table))
        truths = {path.name: json.loads(path.read_text()) for path in paths if path.name.endswith("truth.json")}
        for path in paths:
            if not path.name.endswith("truth.json"):
                target = folder / path.relative_to(temporary)
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(path, target)
    write_text(folder / "rig.toml", tomli_w.dumps({**public, "name": f"axis of student {name}"}))
    write_text(folder / FORM, form(name))
    material = Material.of(Recordings.in_folder(folder))
    return {
        "truth": _truth(table, truths),
        "expected": answers(material),
        "mistakes": {mistake.name: [answers(material, way) for way in mistake.ways] for mistake in MISTAKES},
    }


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
        "rotor_inertia": f"{0.25 * random.uniform(0.8, 1.2):.3f} kg*cm**2",
    }
    motor = motor_table(motor, random.uniform(*SPEEDS))
    bare = Rig.of({**table, "motor": motor, "load": load})
    theory = bare.load.disk_inertia if bare.load else None
    assert theory is not None and bare.motor.rotor_inertia is not None
    inertia = bare.motor.rotor_inertia + theory * (1.0 + random.uniform(*BEYOND_THEORY))
    simulation = {
        **table["simulation"],
        "moment_of_inertia": f"{inertia * KG_CM2:.4f} kg*cm**2",
        "viscous_friction_coefficient": f"{1e3 * random.uniform(*VISCOUS):.4f} mN*m*s/rad",
        "coulomb_friction": f"{1e3 * random.uniform(*COULOMB):.2f} mN*m",
        "velocity_noise": f"{random.uniform(*VELOCITY_NOISE):.2f} deg/s",
        "current_noise": f"{random.uniform(*CURRENT_NOISE):.2f} mA",
    }
    drive = {**table["drive"], "inertia_feedforward": f"{inertia * KG_CM2:.4f} kg*cm**2"}
    return {**table, "motor": motor, "load": load, "drive": drive, "simulation": simulation}


def motor_table(motor: dict[str, Any], speeds: float) -> dict[str, Any]:
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


def form(name: str) -> str:
    """The form that a student fills in."""
    rows = "".join(f"{asked.name},,{asked.unit}\n" for asked in ASKED)
    return f"quantity,value,unit\nstudent,{name},\n{rows}"


def _truth(table: dict[str, Any], truths: dict[str, Any]) -> dict[str, float]:
    """True values under the names of the form, where the simulation has them."""
    rig = Rig.of(table)
    assert rig.simulation is not None and rig.simulation.moment_of_inertia is not None
    inertia, rotor = rig.simulation.moment_of_inertia, rig.motor.rotor_inertia or 0.0
    corner = next(
        t["parameters"]["corner_speed"]["value"] for t in truths.values() if "corner_speed" in t["parameters"]
    )
    return {
        "J": inertia * KG_CM2,
        "J_load": (inertia - rotor) * KG_CM2,
        "J_without_friction": inertia * KG_CM2,
        "J_load_without_friction": (inertia - rotor) * KG_CM2,
        "K_fric_w": rig.simulation.viscous_friction_coefficient,
        "K_fric_0": rig.simulation.coulomb_friction,
        "M_max": rig.motor.peak_torque or 0.0,
        "corner": corner * 30.0 / np.pi,
    }
