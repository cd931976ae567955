"""Encoder eccentricity: the measured position errs once per revolution, the measured velocity accordingly.

    q_m = q + e*sin(q + phi),  omega_m = omega*(1 + e*cos(q + phi))

e - amplitude - rad: eccentricity over radius of the graduation; q - angle of the motor - rad. In the balance
e*sin(q + phi) = s*sin(q) + c*cos(q), and the acceleration errs by d/dt(omega*(s*cos(q) - c*sin(q))).
Source: A. Ernst, Digital Linear and Angular Metrology, 1998 (eccentricity of graduations).
"""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.arrays import NORMAL95, Array, namespace
from bench.effects.effect import EncoderFault, Fitted, Proposal
from bench.effects.shape import Shape
from bench.effects.signals import Axis, Number, Scope, Signals, Values
from bench.effects.waves import PHASE, Wave, amplitude_and_phase
from bench.trace.filter import Column
from bench.units import Quantity

#: Amplitudes that are tried where the bare axis determines no inertia - rad.
AMPLITUDES = (1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3)
#: Newton steps that turn a measured into a true angle at most (error after k below e**(2**k)); least step - rad.
STEPS, LEAST = 5, 1e-9


class EncoderEccentricity(Wave, EncoderFault):
    name = "encoder_eccentricity"
    summary = "measured position errs once per revolution"
    quantities = (Quantity("amplitude", "e", "rad", lower=0.0, upper=0.5, null=0.0), PHASE)
    shapes = (Shape(Quantity("sine", "s", "rad"), additive=True), Shape(Quantity("cosine", "c", "rad"), additive=True))

    def propose(self, fitted: Fitted) -> list[Proposal]:
        """To first order, where the balance is linear in both shapes: it lacks J times the acceleration's error.

        J is that with both. Where another effect takes it, so that no amplitude that there may be follows, a range
        of amplitudes is tried.
        """

        def errors(signals: Signals) -> list[Column]:
            angle, speed = signals.position, signals.velocity
            return [[(speed * np.cos(angle), 1)], [(-speed * np.sin(angle), 1)]]

        columns = fitted.seen(errors, of_motion=True)
        beside = np.column_stack([fitted.columns, columns])
        inertia, *_, sine, cosine = np.linalg.lstsq(beside, fitted.effort, rcond=None)[0].tolist()
        error = float(np.hypot(sine, cosine))
        if error < self.quantities[0].upper * inertia:
            return [Proposal((-sine / inertia, -cosine / inertia), float(fitted.gains(columns, 2)[0]))]
        return fitted.tried(self, [(-share * sine / error, -share * cosine / error) for share in AMPLITUDES])

    def reach(self, shape: Sequence[float], k: int) -> float:
        """A third of the amplitude."""
        return 0.3 * max(float(np.linalg.norm(shape)), 1e-4)

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> Mapping[str, float]:
        amplitude, phase = amplitude_and_phase(*shape)
        return {"amplitude": amplitude, "phase": phase}

    def shape_errors(self, shape: Sequence[float], scope: Scope, time: Array) -> Sequence[float]:
        """By the drift of an integrated position, and by the half tick within which it was taken."""
        return [float(np.linalg.norm(shape)) * (scope.drift + 0.5 * scope.latched * scope.rms_speed / NORMAL95)] * 2

    def measured(self, values: Values, position: Number, velocity: Number) -> tuple[Number, Number]:
        angle, amplitude = position + values["phase"], values["amplitude"]
        xp = namespace(angle)
        return position + amplitude * xp.sin(angle), velocity * (1.0 + amplitude * xp.cos(angle))

    def actual(self, values: Mapping[str, float], position: Array, velocity: Array) -> tuple[Array, Array]:
        amplitude, phase = values["amplitude"], values["phase"]
        return true_motion(position, velocity, amplitude * np.cos(phase), amplitude * np.sin(phase))


def true_motion(position: Array, velocity: Array, sine: float, cosine: float) -> tuple[Array, Array]:
    """Angle and speed (n,) of the motor from measured ones, by Newton's method - rad, rad/s."""
    angle = position
    for _ in range(STEPS):
        sin, cos = np.sin(angle), np.cos(angle)
        step = (angle + sine * sin + cosine * cos - position) / (1.0 + sine * cos - cosine * sin)
        angle = angle - step
        if np.abs(step).max() < LEAST:
            break
    return angle, velocity / (1.0 + sine * np.cos(angle) - cosine * np.sin(angle))


EFFECT = EncoderEccentricity()
