"""How a model moves: its torque in one stated run, so that a change of the simulator is a change too.

The speed reference is a sum of two sines, faded in; the drive a cascade of BANDWIDTH laid out for an inertia, as are
the speeds for a torque. Both come from the model of the baseline, so that every later model runs the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.plant.axis_model import AxisModel
from bench.plant.drive import Cascade
from bench.plant.plant import Plant
from bench.plant.references import References
from bench.plant.run import run

#: Name of the comparison.
RESPONSE_TORQUE = "response_torque"
#: Duration and tick of the run - s -; of its speed: frequencies - Hz -, shares of them, and fade-in - s.
DURATION, TICK = 2.5, 250e-6
FREQUENCIES, SHARES, FADE = (0.8, 3.1), (0.6, 0.4), 0.3
#: Bandwidth of the velocity loop - rad/s -: low enough for a coupling behind the motor.
BANDWIDTH = 30.0
#: Accelerating torque over Coulomb friction; and the least acceleration by `turns` - rad/s**2 (m/s**2).
OVER_FRICTION, LEAST = 3.0, {True: 50.0, False: 0.5}
#: Number of instants at which the torque is kept.
INSTANTS = 24


@dataclass(frozen=True)
class Response:
    """A run of a model.

    Attributes:
        inertia: for which drive and speeds are laid out - kg*m**2 (kg).
        acceleration: largest of the reference - rad/s**2 (m/s**2).
        torque: of the drive at INSTANTS of the run - N*m (N).
    """

    inertia: float
    acceleration: float
    torque: tuple[float, ...]


def response(model: AxisModel, like: Response | None = None) -> Response:
    """Run a model.

    Args:
        model: of an axis.
        like: a run whose drive and speeds are used; without one they are laid out for the model.

    Raises:
        SimulationError: the model diverged.
    """
    own = model.parameters
    least = max(OVER_FRICTION * own.coulomb_friction / own.inertia, LEAST[own.kind.turns])
    inertia, acceleration = (own.inertia, least) if like is None else (like.inertia, like.acceleration)
    wide = BANDWIDTH * inertia
    drive = Cascade(BANDWIDTH / 5.0, wide, wide * BANDWIDTH / 6.0, inertia, model.peak_effort, TICK)
    plant = Plant(own, drive, TICK, effects=model.effects, winding=model.winding)
    torque = run([plant], [_references(acceleration)]).torque[:, 0]
    kept = torque[np.linspace(0, torque.size - 1, INSTANTS + 1).astype(np.intp)[1:]]
    return Response(inertia, acceleration, tuple(kept.tolist()))


def _references(acceleration: float) -> References:
    time: Array = TICK * np.arange(round(DURATION / TICK) + 1, dtype=np.float64)
    omega = 2.0 * np.pi * np.array(FREQUENCIES)
    speeds = np.array(SHARES) * acceleration / omega
    velocity = np.minimum(time / FADE, 1.0) * (speeds @ np.sin(omega[:, None] * time))
    position = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1])) * TICK])
    return References(time, position, velocity, np.gradient(velocity, TICK))
