"""The catapult in MuJoCo: flights with scatter in launch and sensor, and the parabola that each of them truly is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from bench.arrays import Array
from bench.assets import asset
from bench.errors import SimulationError
from bench.files import write_text
from bench.plant.closed_loop import DIVERGED
from bench.structured import json_text

FLIGHTS, POINTS = 10, 20
#: Angles of the arm from the forward horizontal when it is let go, and when the ball is - rad.
COCKED, RELEASE = math.radians(200.0), math.radians(135.0)
#: Scatter of a launch: of the spring's stiffness - share, and of the release - rad; of the sensor: in y and z - m.
STIFFNESS_SCATTER, RELEASE_SCATTER, SENSOR_SCATTER = 0.015, math.radians(0.5), 0.004
#: The flight is seen from its release until this height - m.
LOWEST = 0.05


@dataclass(frozen=True)
class Flight:
    """A flight from its release on.

    Attributes:
        y, z: path, POINTS evenly in time - m.
        coefficients: a - 1/m, b, c - m of z = a*y**2 + b*y + c, from the state at the release alone.
    """

    y: Array
    z: Array
    coefficients: Array


def fly(stiffness_factor: float = 1.0, release: float = RELEASE) -> Flight:
    """Throw the ball once; without arguments as the catapult is built.

    Args:
        stiffness_factor: of the spring against the model's.
        release: angle of the arm at which the ball is let go - rad.

    Raises:
        SimulationError: it diverged or never reached the release.
    """
    model = mujoco.MjModel.from_xml_path(str(asset("mjcf", "catapult.xml")))
    data = mujoco.MjData(model)
    arm = model.joint("arm")
    model.jnt_stiffness[arm.id] *= stiffness_factor
    data.qpos[arm.qposadr[0]] = COCKED
    mujoco.mj_forward(model, data)
    data.qpos[model.joint("ball").qposadr[0] :][:3] = data.site("cup").xpos
    while data.qpos[arm.qposadr[0]] > release:
        mujoco.mj_step(model, data)
        if data.time > 2.0 or data.warning.number.any():
            raise SimulationError(DIVERGED)
    data.eq_active[model.equality("grip").id] = 0
    path, coefficients = [_ball(model, data)[:2]], _parabola(*_ball(model, data), -model.opt.gravity[2])
    while path[-1][1] > LOWEST:
        mujoco.mj_step(model, data)
        path.append(_ball(model, data)[:2])
        if data.time > 10.0:
            raise SimulationError(DIVERGED)
    seen = np.linspace(0, len(path) - 2, POINTS).round().astype(int)
    y, z = np.array(path)[seen].T
    return Flight(y, z, coefficients)


def _ball(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[float, float, float, float]:
    """y, z - m, and their rates - m/s - of the ball."""
    joint = model.joint("ball")
    position, velocity = data.qpos[joint.qposadr[0] :], data.qvel[joint.dofadr[0] :]
    return float(position[1]), float(position[2]), float(velocity[1]), float(velocity[2])


def _parabola(y: float, z: float, speed_y: float, speed_z: float, gravity: float) -> Array:
    """Ballistic path without drag: z = z0 + v_z/v_y*(y - y0) - g/(2*v_y**2)*(y - y0)**2, as a, b, c."""
    a, slope = -gravity / (2.0 * speed_y**2), speed_z / speed_y
    return np.array([a, slope - 2.0 * a * y, z - slope * y + a * y**2])


def scattered_flights(random: np.random.Generator) -> tuple[list[Flight], list[Array]]:
    """Flights as they were, and (POINTS, 2) points of each as the sensor saw them - m."""
    flights, seen = [], []
    for _ in range(FLIGHTS):
        factor = 1.0 + STIFFNESS_SCATTER * random.standard_normal()
        flight = fly(factor, RELEASE + RELEASE_SCATTER * random.standard_normal())
        points = np.stack([flight.y, flight.z], axis=1)
        flights.append(flight)
        seen.append(points + SENSOR_SCATTER * random.standard_normal(points.shape))
    return flights, seen


def record_flights(folder: Path, random: np.random.Generator) -> list[Path]:
    """Write the flights as CSV, one each, and the truth; returns the paths written."""
    flights, seen = scattered_flights(random)
    paths = []
    for number, points in enumerate(seen, start=1):
        path = folder / f"experiment-{number:02}.csv"
        rows = "\n".join(f"{y:.4f},{z:.4f}" for y, z in points)
        write_text(path, f"y [m],z [m]\n{rows}\n")
        paths.append(path)
    nominal = fly().coefficients.tolist()
    units = {"a": "1/m", "b": "1", "c": "m"}
    content = {
        "schema": "bench.truth/1",
        "parameters": {name: {"value": v, "unit": units[name]} for name, v in zip(units, nominal, strict=True)},
        "flights": [flight.coefficients.tolist() for flight in flights],
        "sensor_scatter": {"value": SENSOR_SCATTER, "unit": "m"},
    }
    truth = folder / "truth.json"
    write_text(truth, json_text(content) + "\n")
    return [*paths, truth]
