"""The named effects added to the MuJoCo model, and the velocity gap of the simulation before and after."""

from __future__ import annotations

import math

import numpy as np

from bench.diagnose.fit import Fit
from bench.diagnose.found import Gap, NamedEffect
from bench.diagnose.hypothesis import BACKLASH, ELASTIC
from bench.effects.present import Present
from bench.errors import BenchError, InputError
from bench.identify.estimate import Parameter
from bench.plant.axis_model import AxisModel, winding_of
from bench.plant.model import AxisParameters
from bench.plant.model_file import StoredModel
from bench.plant.track import measured_velocity
from bench.plant.track_effects import track_effects
from bench.rig.rig import Rig
from bench.trace.noise import white_noise
from bench.trace.trace import Trace


def axis_model(
    fitted: Fit, effects: list[NamedEffect], parameters: dict[str, Parameter], rig: Rig
) -> tuple[StoredModel | None, list[str]]:
    """The MuJoCo model with its effects; None and why, where MuJoCo cannot have them with these values."""
    inertia, viscous, coulomb = (found.value for found in list(parameters.values())[:3])
    motor = rig.motor.rotor_inertia or 0.0
    for index, effect in enumerate(fitted.hypothesis.effects):
        if effect.name in (ELASTIC, BACKLASH):
            motor = inertia - float(fitted.strengths(index)[0])
    base = AxisParameters(inertia, max(viscous, 0.0), max(coulomb, 0.0), 0.0, min(motor, inertia), rig.linear)
    constant, current = rig.motor.torque_per_ampere, rig.motor.peak_current
    peak = float(constant.torque(np.asarray(current))) if constant is not None and current is not None else math.inf
    try:
        present = tuple(_present(effect) for effect in effects)
        model = AxisModel(base, present, peak, winding_of(rig))
    except InputError as error:
        return None, [f"not added to the MuJoCo model: {error}"]
    return StoredModel(rig.name, model, float(fitted.theta[3])), []


def _present(effect: NamedEffect) -> Present:
    known = {quantity.name for quantity in Present(effect.name, ()).effect.quantities}
    return Present.of(effect.name, {key: p.value for key, p in effect.parameters.items() if key in known})


def velocity_gap(
    trace: Trace,
    holdout: Trace | None,
    rig: Rig,
    parameters: dict[str, Parameter],
    fitted: Fit,
    model: StoredModel | None,
) -> tuple[Gap, list[str]]:
    """RMS of measured less simulated velocity, without and with the effects, and what kept it from being had."""
    warnings: list[str] = []
    plain = StoredModel(rig.name, AxisModel(_bare(parameters, rig)), float(fitted.theta[3]))
    pairs: list[tuple[float, float] | None] = []
    for recording in (trace, holdout):
        pair = None
        if recording is not None and model is not None:
            try:
                pair = (_gap(plain, recording, rig), _gap(model, recording, rig))
            except BenchError as error:
                warnings.append(f"no velocity gap: {error}")
        pairs.append(pair)
    floor = white_noise(measured_velocity(trace))
    return Gap("m/s" if rig.linear else "rad/s", floor, pairs[0], pairs[1]), warnings


def _bare(parameters: dict[str, Parameter], rig: Rig) -> AxisParameters:
    inertia, viscous, coulomb = (found.value for found in list(parameters.values())[:3])
    return AxisParameters(inertia, max(viscous, 0.0), max(coulomb, 0.0), 0.0, 0.0, rig.linear)


def _gap(stored: StoredModel, trace: Trace, rig: Rig) -> float:
    effort, _ = rig.net_effort(trace)
    simulated = track_effects(stored.model, trace, effort, stored.misalignment)
    return float(np.sqrt(np.mean((simulated - measured_velocity(trace)) ** 2)))
