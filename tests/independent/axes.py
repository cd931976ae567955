"""One plain axis and a way to let it run, for the laws tested here."""

from dataclasses import replace

import numpy as np

from bench.validation.independent.plant import Plant
from bench.validation.independent.rig import Axis

PLAIN = Axis(
    name="plain",
    inertia=1.2e-3,
    viscous=8e-4,
    coulomb=0.06,
    rotor_inertia=4e-4,
    torque_constant=0.7,
    peak_current=6.0,
    resistance=4.0,
    inductance=8e-3,
    back_emf_constant=0.7,
    position_gain=20.0,
    velocity_gain=0.15,
    integral_gain=2.0,
    inertia_feedforward=1.1e-3,
    control_period=250e-6,
)
FREE = replace(PLAIN, viscous=0.0, coulomb=0.0)


def run(plant: Plant, current, duration: float, step: float = 20e-6) -> dict[str, np.ndarray]:
    """Time - (k,) - and states at step ends - (k, n); `current` a number or a function of time - A."""
    names = (
        "position",
        "velocity",
        "load_position",
        "load_velocity",
        "current",
        "acting_current",
        "motor_torque",
        "measured_position",
        "measured_velocity",
    )
    kept: dict[str, list[np.ndarray]] = {name: [] for name in names}
    count = round(duration / step)
    ones = np.ones_like(plant.position)
    for _ in range(count):
        plant.advance(ones * (current(plant.time + step / 2.0) if callable(current) else current), step)
        for name in names:
            kept[name].append(getattr(plant, name).copy())
    return {"time": step * np.arange(1, count + 1)} | {name: np.array(values) for name, values in kept.items()}
