"""Make the course's recordings: the simulated lab axis, recorded as Machine Expert would."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa

from bench.arrays import Array
from bench.course.axis import RPM, circuit, lab_rig, peak_current, torque_constant, without_friction
from bench.course.catapult import record_flights
from bench.course.recordings import FASTEST, WITH_FRICTION, WITHOUT_FRICTION
from bench.course.t11_corner import VELOCITY_GAIN, saturation
from bench.course.winding import STEP, WindingModel, WindingRun, run_winding
from bench.files import whole, write_text
from bench.plant.axis_model import AxisParameters
from bench.plant.sensing import Sensors
from bench.plant.simulate import SCHEMA, simulate, truth_path, write_truth
from bench.rig.limits import COLD
from bench.rig.rig import Rig
from bench.structured import json_text
from bench.trace.readers.codesys import machine_expert_trace
from bench.units import convert

#: The fastest run: speed asked for - rad/s, when, until when - s, and how fast it then stops - rad/s**2.
TOP_SPEED, START, STOP, BRAKING = 4500.0 / RPM, 0.02, 0.6, 700.0


def record(
    folder: Path, seed: int = 0, progress: Callable[[float], None] = lambda share: None, rig: Rig | None = None
) -> list[Path]:
    """Simulate an axis and write its recordings, each with its truth, and the catapult's flights.

    Args:
        folder: to write to.
        seed: of the sensors' noise.
        progress: called with the share done.
        rig: of the axis, with `[drive]` and `[simulation]`; the lab's without.

    Returns:
        Paths written.
    """
    rig = rig or lab_rig()
    paths = []
    for name, axis in ((WITHOUT_FRICTION, without_friction(rig)), (WITH_FRICTION, rig)):
        simulated = simulate(axis, "fast_reversals", seed)
        path = folder / f"{name}.trace"
        trace = simulated.trace
        _write(path, trace.time, trace["velocity"], trace["current"])
        paths += [path, write_truth(path, simulated.truth)]
        progress(0.2 * len(paths) / 2.0)
    paths += _record_fastest(folder / f"{FASTEST}.trace", rig, np.random.default_rng(seed))
    progress(0.7)
    paths += record_flights(folder / "catapult", np.random.default_rng(seed))
    progress(1.0)
    return paths


def fastest_run(rig: Rig) -> WindingRun:
    """The run-up with full torque, cold and with inductance, then the stop."""
    winding = WindingModel(circuit(rig), torque_constant(rig), peak_current(rig), COLD, inductive=True)
    time = np.arange(0.0, STOP + TOP_SPEED / BRAKING + START, STEP)
    demand = np.where(time < START, 0.0, np.clip(TOP_SPEED - BRAKING * (time - STOP), 0.0, TOP_SPEED))
    return run_winding(winding, AxisParameters.from_rig(rig), demand, VELOCITY_GAIN)


def _record_fastest(path: Path, rig: Rig, random: np.random.Generator) -> list[Path]:
    run, sensors, axis = fastest_run(rig), Sensors.from_rig(rig), AxisParameters.from_rig(rig)
    every = slice(None, None, round(sensors.sample_period / STEP))
    time, velocity, current = run.time[every], run.velocity[every], run.current[every]
    velocity = velocity + sensors.velocity_noise * random.standard_normal(time.size)
    _write(path, time, velocity, current + sensors.current_noise * random.standard_normal(time.size))
    parameters = {
        "moment_of_inertia": {"value": axis.inertia, "unit": "kg*m**2"},
        "viscous_friction_coefficient": {"value": axis.viscous_friction_coefficient, "unit": "N*m*s/rad"},
        "coulomb_friction_torque": {"value": axis.coulomb_friction, "unit": "N*m"},
        "corner_speed": {"value": saturation(run, circuit(rig).voltage), "unit": "rad/s"},
    }
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
