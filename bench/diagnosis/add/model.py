"""The MuJoCo model of a fit: the axis with the effects named in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.axis_kind import MISALIGNMENT
from bench.effects.effect import Effect
from bench.effects.kinds import Friction, Moment
from bench.effects.present import Present
from bench.errors import InputError
from bench.fit.fit import Fit
from bench.plant.axis_model import AxisModel, winding_of
from bench.plant.model import AxisParameters
from bench.plant.model_file import Mounting, StoredModel
from bench.rig.rig import Rig

#: Bandwidth of the cascade by which a model tracks a recording - rad/s -, and the largest that a model may need. On the
#: shared cases the effects found reduce the gap by a median factor of 15 at 10, 16 at 20 and 14 at 40 rad/s; at 20 none
#: fails to track (docs/diagnose.md).
BANDWIDTH, MOST = 20.0, 100.0
#: Number of speeds at which the slope of friction is evaluated, and the lowest as share of the top speed.
SPEEDS, SLOWEST = 400, 1e-3


def stored_model(fitted: Fit, beside: Sequence[Present], rig: Rig) -> StoredModel:
    """The axis of a fit in MuJoCo.

    Args:
        fitted: J, K_w, K_0 and effects of the torque balance.
        beside: effects outside the torque balance.
        rig: of the axis.

    Raises:
        InputError: MuJoCo cannot have the effects with these values, or no inertia.
    """
    inertia, viscous, coulomb = fitted.theta[:3].tolist()
    if inertia <= 0.0:
        raise InputError(rig.source, f"found an inertia of {inertia:.3g}", "allowed: above zero")
    motor = rig.motor.rotor_inertia or rig.motor.moving_mass or 0.0
    coupling = fitted.hypothesis.coupling
    if coupling is not None:
        motor = inertia - fitted.terms[coupling].effect.load_inertia(fitted.strengths(coupling))
    base = AxisParameters(inertia, max(viscous, 0.0), max(coulomb, 0.0), 0.0, min(motor, inertia), rig.axis_kind)
    present = [
        present_of(term.effect, term.effect.report(fitted.strengths(index), term.shape, fitted.base))
        for index, term in enumerate(fitted.terms)
    ]
    model = AxisModel(base, (*present, *beside), fitted.scope.peak_effort, winding_of(rig))
    return StoredModel(rig.name, model, fitted.value(MISALIGNMENT), Mounting.of(rig))


def present_of(effect: Effect, values: Mapping[str, float]) -> Present:
    """An effect with its quantities among the values; those that noise moved beyond a bound are set to it."""
    known = {quantity.name: quantity for quantity in effect.quantities}
    bounded = {key: float(np.clip(values[key], known[key].lower, known[key].upper)) for key in values if key in known}
    return Present.of(effect.name, bounded)


def without_events(model: AxisModel) -> AxisModel:
    """The axis in a recording without its events."""
    return model.with_effects([present for present in model.effects if not present.effect.occasional])


def holding_bandwidth(model: AxisModel, top_speed: float) -> float:
    """Bandwidth of the cascade by which a model tracks a recording - rad/s.

    Where friction falls as speed rises by c - N*m*s/rad -, the held axis J*s**2 + (K_v + K_w - c)*s + K_i runs away
    from the recording unless K_v = J*w exceeds c - K_w: small errors grow where the axis under its own drive was
    stable. Then the model is held as firmly as that takes.

    Args:
        model: with all its effects.
        top_speed: of the recording - rad/s (m/s).
    """
    speed = np.geomspace(SLOWEST, 1.0, SPEEDS) * max(top_speed, 1e-9)
    nothing = np.zeros_like(speed)
    level = model.parameters.viscous_friction_coefficient * speed
    for present in model.of_kind(Friction):
        assert isinstance(present.effect, Friction)
        at = Moment(0.0, nothing, speed, nothing)
        level = level + present.effect.friction_excess(dict(present.values), model.axis, at)
    fall = max(0.0, -float(np.min(np.diff(level) / np.diff(speed))))
    return float(np.clip(fall / model.parameters.inertia, BANDWIDTH, MOST))
