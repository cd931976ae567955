"""One axis for both worlds, and every effect of the catalogue with values that suit it, in each world's words."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.signal import lsim

from bench.effects.present import Present
from bench.effects.signals import Winding
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.drive import Cascade, References
from bench.plant.plant import Plant, States
from bench.plant.run import run
from bench.validation.independent.effects import KINDS, Effect, Rows
from bench.validation.independent.rig import Axis
from bench.validation.independent.sensors import Sensors
from bench.validation.independent.simulate import simulate
from tests.independent.axes import PLAIN

PERIOD = 125e-6
IDEAL = Sensors(sample_period=PERIOD, encoder_resolution=0.0)
#: The independent drive sums errors up to the last tick, the bench's takes half of the present one too.
AXIS = replace(PLAIN, control_period=PERIOD, velocity_gain=PLAIN.velocity_gain + PLAIN.integral_gain * PERIOD / 2.0)

PARAMETERS = AxisParameters(AXIS.inertia, AXIS.viscous, AXIS.coulomb, motor_inertia=AXIS.rotor_inertia)
CASCADE = Cascade(
    AXIS.position_gain,
    PLAIN.velocity_gain,
    AXIS.integral_gain,
    AXIS.inertia_feedforward,
    AXIS.peak_torque,
    PERIOD,
)
WINDING = Winding(AXIS.torque_constant, AXIS.resistance, AXIS.inductance, AXIS.back_emf_constant)

LAG, CURRENT_LAG = "velocity_filter_lag", "current_filter_lag"
#: Values that disturb this axis well and that it still bears.
VALUES: dict[str, dict[str, float]] = {
    "stribeck_friction": {"static_friction": 0.14, "stribeck_velocity": 5.0},
    "presliding_friction": {"bristle_stiffness": 2.5, "bristle_damping": 2e-3},
    "direction_dependent_friction": {"coulomb_difference": 0.05, "viscous_difference": 4e-4},
    "quadratic_drag": {"quadratic_drag": 1.5e-5},
    "load_dependent_friction": {"load_friction_coefficient": 0.12},
    "position_dependent_friction": {"relative_amplitude": 0.6, "phase": 0.7},
    "friction_warmup": {"relative_amplitude": 1.2, "time_constant": 0.8, "viscous_share": 1.0},
    "torque_offset": {"torque": -0.12},
    "unbalance": {"amplitude": 0.2, "phase": -0.5},
    "torsion_spring": {"stiffness": 0.02, "reference": 1.5},
    "position_dependent_inertia": {"relative_amplitude": 0.1, "harmonic": 2.0, "phase": 0.4},
    "elastic_coupling": {"stiffness": 40.0, "damping": 0.01},
    "backlash": {"gap": 0.02, "contact_stiffness": 420.0, "contact_damping": 0.13},
    "load_torque_event": {"torque": 0.2, "start": 0.3, "end": 0.5},
    "cogging_torque": {"amplitude": 0.08, "harmonic": 6.0, "phase": 1.1},
    "torque_ripple": {"relative_amplitude": 0.15, "harmonic": 4.0, "phase": -1.0},
    "torque_constant_saturation": {"drop_at_peak": 0.2},
    "voltage_limit": {"voltage": 36.0},
    "current_loop_lag": {"time_constant": 2e-3},
    "velocity_filter_lag": {"time_constant": 2e-3},
    "encoder_eccentricity": {"amplitude": 0.02, "phase": 0.9},
    "current_filter_lag": {"time_constant": 2e-3},
    "current_gain_asymmetry": {"gain_difference": 0.15},
    "current_offset_drift": {"rate": 0.3},
    "torque_constant_drift": {"rate": -0.3},
    "torque_scale": {"scale": 1.2},
    "directional_load_friction": {"motor_coefficient": 0.1, "load_ratio": 2.0},
}


def present(name: str, **values: float) -> Present:
    """The effect for the bench, some of its values others."""
    return Present.of(name, VALUES[name] | values)


@dataclass(frozen=True)
class TorqueScale(Effect):
    """One ampere that acts is read as `scale`. KINDS are hidden without a known weight, so it is none of them."""

    scale: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(float(np.exp(rng.choice([-1.0, 1.0]) * 0.3 * severity)))

    def true_current(self, rows: Rows, reading: np.ndarray) -> np.ndarray:
        return reading / self.scale


def independent(name: str) -> Effect:
    """The same for the independent axis."""
    values = dict(VALUES[name])
    if name == TorqueScale.name:
        return TorqueScale(**values)
    if name == "direction_dependent_friction":
        ratio = values.pop("viscous_difference") / AXIS.viscous
        values["viscous_share"] = ratio * AXIS.coulomb / values["coulomb_difference"]
    return KINDS[name](**values)


def model(*names: str) -> AxisModel:
    """The axis with effects."""
    return AxisModel(PARAMETERS, tuple(present(name) for name in names), AXIS.peak_torque, WINDING)


def plant(*names: str) -> Plant:
    """The axis with effects under its drive."""
    return Plant(model(*names), CASCADE, PERIOD)


#: The same without friction, for closed forms.
FREE = AxisParameters(AXIS.inertia, motor_inertia=AXIS.rotor_inertia)


def moved(
    effects: list[Present],
    duration: float,
    torque: float = 0.0,
    velocity: float = 0.0,
    position: float = 0.0,
    parameters: AxisParameters = FREE,
) -> States:
    """Motion of an axis under a constant demanded torque: the drive has no gains, its feed-forward is the torque."""
    time = PERIOD * np.arange(round(duration / PERIOD) + 1)
    still = np.zeros_like(time)
    references = References(time, still + position, still + velocity, still + torque)
    open_loop = Cascade(0.0, 0.0, 0.0, 1.0, AXIS.peak_torque, PERIOD)
    return run(Plant(AxisModel(parameters, tuple(effects), winding=WINDING), open_loop, PERIOD), references)


class Reversals:
    """A motion of both worlds: fast and slow reversals of speed. It starts without speed and acceleration."""

    #: Share of the speed, and frequency - Hz.
    PARTS = ((0.6, 2.0), (0.3, 5.0), (-2.7 / 11.0, 11.0))

    def __init__(self, duration: float = 1.0, speed: float = 60.0) -> None:
        self.duration, self.speed = duration, speed

    def at(self, time: np.ndarray) -> np.ndarray:
        """Position, speed, acceleration reference - (3, n)."""
        position, speed, acceleration = np.zeros((3, time.size))
        for share, frequency in self.PARTS:
            w = 2.0 * np.pi * frequency
            position += self.speed * share * (1.0 - np.cos(w * time)) / w
            speed += self.speed * share * np.sin(w * time)
            acceleration += self.speed * share * w * np.cos(w * time)
        return np.stack([position, speed, acceleration])

    def references(self, period: float = PERIOD) -> References:
        """The same at the bench's ticks."""
        time = period * np.arange(int(self.duration / period + 1e-9) + 1)
        return References(time, *self.at(time))


def truth(cases: list[tuple[str, ...]], motion: Reversals) -> list[dict[str, np.ndarray]]:
    """The independent axis with each set of effects along a motion: true and measured signals at every tick.

    The bench filters what is recorded of velocity and current, once a tick, and not what the drive has of them; so is
    it done here, by lsim.
    """
    count = len(cases)
    effects = [[independent(name) for name in names if name not in (LAG, CURRENT_LAG)] for names in cases]
    recorded = simulate([AXIS] * count, [motion] * count, effects, [IDEAL] * count)
    signals = [{**r.true, "measured_position": r.trace["position"]} for r in recorded]
    for names, found in zip(cases, signals, strict=True):
        if LAG in names:
            velocity = found["measured_velocity"]
            time = PERIOD * np.arange(velocity.size)
            found["measured_velocity"] = lsim(([1.0], [VALUES[LAG]["time_constant"], 1.0]), velocity, time)[1]
        if CURRENT_LAG in names:
            time, lag = PERIOD * np.arange(found["current"].size), VALUES[CURRENT_LAG]["time_constant"]
            found["current"] = lsim(([1.0], [lag, 1.0]), found["current"], time, X0=lag * found["current"][0])[1]
    return signals
