"""Voltage limit: the drive runs out of voltage at speed, and current falls behind its demand.

    L*dI/dt = U - R*I - K_e*omega,  |U| <= U_max

U_max - voltage - V; L, R, K_e - inductance - H, resistance - ohm, back-EMF constant - V*s/rad (V*s/m) of the winding.
The current loop brings the current to its demand as fast as the voltage allows, and what flows is what is reported.
Source: W. Leonhard, Control of Electrical Drives (current control under limited voltage).
"""

from collections.abc import Mapping

import numpy as np

from bench.arrays import NORMAL95, Array, namespace
from bench.effects.effect import Detected, DriveLimit, smoothed
from bench.effects.signals import Axis, Number, Values
from bench.errors import InputError
from bench.rig.rig import Rig
from bench.trace.filter import GaussianFilter
from bench.trace.trace import Trace
from bench.units import Quantity

#: Time constant of a winding without inductance - s: none, but for a division.
QUICKEST = 1e-12
#: Speed behind its reference that counts as falling behind, as share of the largest reference.
BEHIND = 0.02
#: Share of the top within which the voltage counts as at it; share of the samples behind that do, and samples.
TOP, STANDING, SAMPLES = 0.045, 0.5, 20
#: Samples above the top not behind, over those behind: 0.10 at most of a limit (`tests.studies.blind.margins`).
BEYOND = 0.13
#: Share of the top speed below which an axis is at rest.
RESTING = 0.02
#: Share of the limit above which the voltage counts as all that there is, and samples in a row that it must.
NEARLY, STEADY = 0.97, 5
#: Length of the motion in which the limit is shown - s: the drive is ticked; and of what follows its first reaching it.
LONGEST, SHORTEST = 3.0, 0.5


class VoltageLimit(DriveLimit):
    name = "voltage_limit"
    summary = "the drive runs out of voltage at speed"
    quantities = (Quantity("voltage", "U_max", "V", lower=0.0, null=np.inf),)

    def detect(self, trace: Trace, rig: Rig, width: float) -> Detected | None:
        """The top of U = R*I + K_e*omega + L*dI/dt at which speed falls behind its reference.

        None where speed never falls behind, does so at less voltage than it keeps up with or where it is the current
        that stays at its top; nor where the rig lacks the winding or the recording the reference.
        """
        motor = rig.motor
        known = motor.resistance is not None and motor.back_emf_constant is not None
        if not known or not {"current", "velocity_reference", "velocity"} <= set(trace.signals):
            return None
        smooth = GaussianFilter(max(width, 1.5 * trace.sample_period), trace.sample_period)
        current, slope = smoothed(trace, smooth, "current", 0, 1)
        (speed,), (wanted,) = (smoothed(trace, smooth, name, 0) for name in ("velocity", "velocity_reference"))
        needed = motor.resistance * current + motor.back_emf_constant * speed + (motor.inductance or 0.0) * slope
        voltage, lack = np.abs(needed), np.sign(wanted) * (wanted - speed)
        behind = lack > BEHIND * float(np.abs(trace["velocity_reference"]).max())
        many = int(np.count_nonzero(behind))
        if many < SAMPLES:
            return None
        top = _top(voltage[behind], many)
        standing = behind & (np.abs(voltage / top - 1.0) < TOP)
        count = int(np.count_nonzero(standing))
        if count < max(SAMPLES, STANDING * many) or np.count_nonzero(~behind & (voltage > top)) > BEYOND * many:
            return None
        most = np.abs(current) > (1.0 - TOP) * _top(np.abs(current), many)
        if np.count_nonzero(behind & most) >= count:  # it is the current that is limited
            return None
        level = voltage[standing]
        error = float(level.std() / np.sqrt(max(1.0, count * smooth.sample_period / (4.0 * smooth.width))))
        evidence = {"samples_at_the_limit": float(count), "speed_behind": float(lack[standing].max())}
        return Detected({"voltage": float(np.median(level))}, {"voltage": NORMAL95 * error}, evidence)

    def shown_in(self, trace: Trace, rig: Rig, values: Mapping[str, float]) -> Trace:
        """From the last rest before the motor first needs all of the voltage, for at most LONGEST."""
        motor = rig.motor
        emf = (motor.back_emf_constant or 0.0) * trace["velocity"]
        needed = np.abs((motor.resistance or 0.0) * trace["current"] + emf)
        steadily = np.convolve(needed > NEARLY * values["voltage"], np.ones(STEADY), "valid") >= STEADY
        first = int(np.argmax(steadily))
        reference = trace["velocity_reference"]
        resting = np.abs(reference) + np.abs(trace["velocity"]) < RESTING * np.abs(reference).max()
        rests = np.flatnonzero(resting[: first + 1])
        start = float(trace.time[rests[-1] if rests.size else 0])
        return trace.between(start, max(start + LONGEST, float(trace.time[first]) + SHORTEST))

    def flowing(
        self, values: Values, axis: Axis, velocity: Number, demand: Number, before: Number, step: float
    ) -> tuple[Number, Number]:
        """Full voltage until the current is what is demanded, then what keeps it there, if the limit allows."""
        winding, xp = axis.winding, namespace(demand)
        if winding is None:
            raise InputError(
                self.name,
                "found a motor without resistance, inductance or constant",
                "allowed: a rig whose [motor] states resistance, inductance, back_emf_constant and torque_constant",
            )
        constant = winding.torque_constant
        tau = xp.maximum(winding.inductance / winding.resistance, QUICKEST)
        wanted, start = demand / constant, before / constant
        emf = winding.back_emf_constant * velocity
        limit = values["voltage"]
        holds = abs(emf + winding.resistance * wanted) <= limit
        full = xp.where(
            holds, xp.copysign(limit, wanted - start), xp.copysign(limit, emf + winding.resistance * wanted)
        )
        settled = (full - emf) / winding.resistance
        until = xp.where(holds, _time_to(wanted, start, settled, tau, step), step)
        decay = xp.exp(-until / tau)
        end = xp.where(holds & (until < step), wanted, settled + (start - settled) * decay)
        area = settled * until + (start - settled) * tau * (1.0 - decay) + wanted * (step - until)
        return constant * area / step, constant * end


def _top(values: Array, many: int) -> float:
    """Median of the largest of magnitudes (n,), as many as a quarter of `many`."""
    return float(np.median(np.sort(values)[-max(SAMPLES, many // 4) :]))


def _time_to(wanted: Number, start: Number, settled: Number, tau: Number, step: float) -> Number:
    """Time in which a current that tends to `settled` goes from `start` to `wanted`, at most a step - s."""
    xp = namespace(wanted)
    ratio = (start - settled) / xp.where(wanted == settled, xp.inf, wanted - settled)
    return xp.minimum(tau * xp.log(xp.maximum(ratio, 1.0)), step)


EFFECT = VoltageLimit()
