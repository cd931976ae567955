"""Make the course's recordings as Machine Expert would: of the simulated lab axis, or of an own one a student.

A class has a folder a student, and the truth of all in one sealed file elsewhere.
"""

from __future__ import annotations

import json
import secrets
import shutil
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import tomli_w

from bench.arrays import Array
from bench.course.answers import Worked, every_mistake, tolerances
from bench.course.axis import embedded, lab_rig, motor_value, without_friction
from bench.course.catapult import record_flights
from bench.course.grade import SEALED, key_path, seal
from bench.course.methods import KG_CM2, RPM
from bench.course.plausible import FASTEST, WITH_FRICTION, WITHOUT_FRICTION
from bench.course.recordings import LabRecordings, read_truth
from bench.course.submission import FORM, form
from bench.course.winding import STEP, run_winding
from bench.errors import InputError
from bench.files import whole, write_text
from bench.plant.axis_model import AxisParameters
from bench.plant.sensing import Sensors
from bench.plant.simulate import SCHEMA, simulate, truth_path, write_truth
from bench.rig.limits import COLD
from bench.rig.motor import catalogue_motor
from bench.rig.rig import Rig
from bench.structured import json_text
from bench.trace.readers.codesys import machine_expert_trace
from bench.units import convert

#: The fastest run: speed asked for - rad/s, when, until when - s, and how fast it then stops - rad/s**2.
TOP_SPEED, START, STOP, BRAKING = 4500.0 / RPM, 0.02, 0.6, 700.0
#: Ranges that students' axes are drawn from.
DIAMETER, THICKNESS = (0.130, 0.145), (5.5e-3, 7.5e-3)  # of the disk - m
BEYOND_THEORY = (0.10, 0.20)  # share of hub, coupling and bolts in the disk's theory
VISCOUS, COULOMB = (0.7e-3, 1.8e-3), (0.06, 0.11)  # N*m*s/rad, N*m
DATASHEET = (0.97, 1.03)  # factor on stall torque, peak torque and peak current
ROTOR = (0.8, 1.2)  # factor on its inertia
SPEEDS = (0.95, 1.05)  # factor on the speeds of the peak curves
VELOCITY_NOISE, CURRENT_NOISE = (1.0, 2.0), (3.0, 8.0)  # deg/s, mA

Progress = Callable[[float], None]


def record(folder: Path, seed: int = 0, progress: Progress = lambda share: None, rig: Rig | None = None) -> list[Path]:
    """Simulate an axis and write its recordings, each with its truth, and the catapult's flights; returns the paths.

    Args:
        folder: where to write.
        seed: of the sensors' noise.
        progress: called with the share done.
        rig: of the axis, with `[drive]` and `[simulation]`; the lab's without.
    """
    rig = rig or lab_rig()
    paths = []
    for name, axis in ((WITHOUT_FRICTION, without_friction(rig)), (WITH_FRICTION, rig)):
        simulated = simulate(axis, "fast_reversals", seed)
        path, trace = folder / f"{name}.trace", simulated.trace
        _write(path, trace.time, trace["velocity"], trace["current"])
        paths += [path, write_truth(path, simulated.truth)]
        progress(0.2 * len(paths) / 2.0)
    paths += _record_fastest(folder / f"{FASTEST}.trace", rig, np.random.default_rng(seed))
    progress(0.7)
    paths += record_flights(folder / "catapult", np.random.default_rng(seed))
    progress(1.0)
    return paths


def _record_fastest(path: Path, rig: Rig, random: np.random.Generator) -> list[Path]:
    """The run-up with full torque, cold and with inductance, then the stop."""
    time = np.arange(0.0, STOP + TOP_SPEED / BRAKING + START, STEP)
    demand = np.where(time < START, 0.0, np.clip(TOP_SPEED - BRAKING * (time - STOP), 0.0, TOP_SPEED))
    sensors, axis = Sensors.from_rig(rig), AxisParameters.from_rig(rig)
    run = run_winding(rig, axis, demand, COLD, True)
    every = slice(None, None, round(sensors.sample_period / STEP))
    time, velocity, current = run.time[every], run.velocity[every], run.current[every]
    velocity = velocity + sensors.velocity_noise * random.standard_normal(time.size)
    _write(path, time, velocity, current + sensors.current_noise * random.standard_normal(time.size))
    known = {**dict([*axis.values.items()][:3]), "corner_speed": (run.corner, "rad/s")}
    parameters = {name: {"value": value, "unit": unit} for name, (value, unit) in known.items()}
    content = {"schema": SCHEMA, "rig": rig.name, "kind": "rotary", "profile": "fastest run-up"}
    write_text(truth_path(path), json_text({**content, "parameters": parameters}) + "\n")
    return [path, truth_path(path)]


def _write(path: Path, time: Array, velocity: Array, current: Array) -> None:
    """Machine Expert trace in deg/s to 1e-3 and mA to 1e-1, well below the sensors' noise, which keeps it small."""
    table = pa.table(
        {
            "time [ms]": np.round(time * 1e3, 3),
            "velocity [deg/s]": np.round(convert(velocity, "rad/s", "deg/s"), 3),
            "current [mA]": np.round(convert(current, "A", "mA"), 1),
        }
    )
    with whole(path) as temporary:
        temporary.write_bytes(machine_expert_trace(table))


def record_class(
    folder: Path, students: int, seed: int, progress: Progress = lambda share: None, salt: int | None = None
) -> list[Path]:
    """Simulate every student's axis and write folders `student-01`, ..., and the truth next to the folder of them all.

    Args:
        folder: of the class, new or empty; InputError where it is not.
        students: how many; InputError below one.
        seed: of everything drawn, with a salt that only the truth contains: the seed alone draws other axes.
        progress: called with the share done.
        salt: random without; a given one draws the same class again.

    Returns:
        The students' folders, and the files of the key and of the truth that it seals, readable by their owner alone.
    """
    if students < 1:
        raise InputError("--students", f"found {students}", "allowed: 1 or more")
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(folder, "is there and not empty", "name a new folder for the class")
    folders, known, salt = [], {}, secrets.randbits(128) if salt is None else salt
    for number in range(1, students + 1):
        name = f"{number:02}"
        folders.append(folder / f"student-{name}")
        known[name] = _record_student(folders[-1], name, np.random.default_rng([seed, number, salt]))
        progress(number / students)
    own = folder if folder.name not in ("", "..") else folder.resolve()  # "." has no name of its own
    truth = own.with_name(f"{own.name}.truth.json")
    content = {"schema": SEALED, "seed": seed, "salt": f"{salt:032x}", "students": known}
    key = secrets.token_hex()
    sealed = json.dumps({**content, "seal": seal(content, key)}, indent=1)
    for path, text in ((key_path(truth), key), (truth, sealed)):
        path.touch(0o600)
        path.chmod(0o600)
        write_text(path, text + "\n")
    return [*folders, key_path(truth), truth]


def _record_student(folder: Path, name: str, random: np.random.Generator) -> dict[str, Any]:
    """Write one folder; returns its truth, the course's own answers, and the figures of every mistake."""
    table = draw_rig(random)
    rig = Rig.of(table)
    with tempfile.TemporaryDirectory() as temporary:
        paths = record(Path(temporary), int(random.integers(2**31)), rig=rig)
        corner = read_truth(truth_path(Path(temporary) / f"{FASTEST}.trace"))["corner_speed"]
        for path in paths:
            if not path.name.endswith("truth.json"):
                target = folder / path.relative_to(temporary)
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(path, target)
    public = {key: value for key, value in table.items() if key != "simulation"}
    public["drive"] = {key: value for key, value in table["drive"].items() if key != "inertia_feedforward"}
    write_text(folder / "rig.toml", tomli_w.dumps({**public, "name": f"axis of student {name}"}))
    write_text(folder / FORM, form(name))
    worked = Worked(LabRecordings.in_folder(folder))
    # seven digits: a class of forty is 3 MB then
    mistakes = [
        [names, {name: float(f"{value:.7g}") for name, value in figures.items() if name not in worked.unchanged}]
        for names, figures in every_mistake(worked)
    ]
    found = {"truth": _truth(rig, corner), "expected": worked.answers(), "tolerance": tolerances(worked)}
    return {**found, "mistakes": mistakes}


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
    motor = _motor_table(motor, random.uniform(*SPEEDS))
    bare = Rig.of({**table, "motor": motor, "load": load})
    theory = bare.load.disk_inertia if bare.load else None
    assert theory is not None, "the embedded rig has a disk"
    inertia = (motor_value(bare, "rotor_inertia") + theory * (1.0 + random.uniform(*BEYOND_THEORY))) * KG_CM2
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


def _motor_table(motor: Mapping[str, Any], factor: float) -> dict[str, Any]:
    """A motor table with its catalogue entry filled in, as a rig file's is when it is read; speeds times a factor."""
    entry = catalogue_motor(motor["model"], "embedded rig")

    def times(speed: str) -> str:
        value, unit = speed.split()
        return f"{float(value) * factor:.0f} {unit}"

    curves = [
        {key: value if key == "mains_voltage" else times(value) for key, value in curve.items()}
        for curve in entry["peak_curves"]
    ]
    return {**entry, **motor, "peak_curves": curves}


def _truth(rig: Rig, corner: float) -> dict[str, float]:
    """True values under the names of the form, where the simulation has them; corner - rad/s."""
    axis = AxisParameters.from_rig(rig)
    inertia, load = axis.inertia * KG_CM2, (axis.inertia - motor_value(rig, "rotor_inertia")) * KG_CM2
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
