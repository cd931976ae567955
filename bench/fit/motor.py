"""Constants of a motor from a recording of its voltage, with its current where that is recorded too.

    U = kS*sgn(w) + kV*w + kA*a            voltage and motion, by the names of WPILib's SysId
    U = R*I + L*dI/dt + Ke*w               voltage, current and motion
    kT = J*a/I  or  M/I                    from a known inertia J, or the known torque M of a weight

U - voltage - V; I - current - A; w, a - speed, acceleration - rad/s, rad/s**2 (m/s, m/s**2); kS - V; kV, Ke - V*s/rad
(V*s/m); kA - V*s**2/rad (V*s**2/m); R - ohm; kT - N*m/A (N/A).

A voltage that is held between samples, or sent late, acts s later than it is recorded. s and the winding's L/R look
alike - dU/dt differs from R*dI/dt only by the slow Ke*a - but s makes R and kA smaller: columns I, w, dI/dt are right
for s = 0, and I, w, dU/dt for L = 0. R and kA are between the two, and their intervals cover what may be L/R.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from bench.arrays import NORMAL95, Array, rms, splined
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS
from bench.errors import InputError, UndeterminedError
from bench.fit.estimate import Estimate, MotorConstants
from bench.fit.regression import DETERMINED, LEAST, STEPS, filtered, regressed
from bench.fit.sampled import sampled
from bench.gate.check import Seen
from bench.gate.velocity import compared
from bench.names import words
from bench.parameter import Parameter
from bench.rig.rig import Rig
from bench.trace.motion import ONE_SIGN, condition, known_sign, measured_velocity, raw_speed
from bench.trace.noise import white_noise
from bench.trace.signals import KNOWN_TORQUE
from bench.trace.trace import Trace

#: Names of the coefficients of the equation of motion whose effort is a voltage.
FEEDFORWARD = {COULOMB: "kS", VISCOUS: "kV", INERTIA: "kA", OFFSET: "kG"}
RESISTANCE, BACK_EMF, SPEED = "resistance", "back_emf_constant", "speed_constant"
#: Values by which a rig makes torque of a voltage or a current.
SCALES = ("torque_constant", "force_constant", "torque_per_volt", "force_per_volt", "resistance", "back_emf_constant")
SCALES += ("continuous_stall_torque", "continuous_stall_current", "peak_torque", "peak_current")
#: Samples in a time constant from which filtered derivatives serve, and from which they are right up to half a hold.
FEW, ENOUGH = 20.0, 5.0
#: Samples by which the motion must be late for a voltage to be held between samples.
HELD = 0.25
#: Longest L/R of a winding whose rig does not give it - s: small motors have 0.1 to 2 ms.
LONGEST = 5e-3
#: Inertia and friction of the effort that a signal of a recording is.
By = Callable[[str, Trace], Estimate]


def motor_constants(
    trace: Trace, rig: Rig, found: Estimate, identified: Callable[[Trace, Rig], Estimate]
) -> MotorConstants | None:
    """Of a recording and its estimate; None without a voltage. `identified`: the estimate of another recording."""
    if "voltage" not in trace:
        return None
    known, refused = dict[str, Parameter](), dict[str, str]()
    constant = f"{rig.axis_kind.effort}_constant"
    parts = {"kS, kV, kA": _feedforward}
    if "current" in trace:
        parts |= {f"{RESISTANCE}, {BACK_EMF}": _circuit, constant: _scale}

    bare = rig.model_copy(update={"motor": rig.motor.model_copy(update=dict.fromkeys(SCALES))})

    def by(signal: str, of: Trace) -> Estimate:
        """Inertia and friction of the effort that a signal of a recording is, in its unit."""
        if of is trace and found.residual.unit == {"voltage": "V", "current": "A"}[signal]:
            return found
        only = of.with_signals({"voltage": rig.voltage(of)}, {"voltage": "V"})
        for name in {"voltage", "current", rig.axis_kind.effort} - {signal}:
            only = only.without(name) if name in only else only
        return identified(only, bare)

    for name, of in parts.items():
        try:
            known |= of(trace, rig, by)
        except UndeterminedError as error:
            refused[name] = f"{error.reason}; record instead: {error.record}"
        except InputError as error:
            refused[name] = str(error)
    if "kA" in known and _samples_of(known, trace) < FEW and ("current" not in trace or _read_before(trace, rig)):
        try:
            known |= _by_samples(trace, rig, known)
        except UndeterminedError as error:
            known |= {"kA": known["kA"].reaching(known["kA"].value - 0.5 * trace.sample_period * known["kV"].value)}
            if _samples_of(known, trace) < ENOUGH:
                del known["kA"]
                refused["kA"] = f"{error.reason}; record instead: {error.record}"
    if constant in refused and BACK_EMF in known:
        ideal = f"{known[BACK_EMF].value:.4g} {rig.axis_kind.effort_unit}/A"
        refused[constant] += f"; in a motor without losses it is {ideal}, as the back-EMF constant"
    supply = trace.signals.get("supply_voltage")
    return MotorConstants(known, refused, None if supply is None else (float(supply.min()), float(supply.max())))


def _feedforward(trace: Trace, rig: Rig, by: By) -> dict[str, Parameter]:
    """kS, kV, kA, and kG of a constant load where it is fitted."""
    if KNOWN_TORQUE in trace or _weighted(rig):
        raise UndeterminedError("kS, kV, kA", "a known load acts in addition", "the axis without it")
    names = {rig.axis_kind.parameter(term): name for term, name in FEEDFORWARD.items()}
    late, found = rig.axis_kind.parameter(MISALIGNMENT), by("voltage", trace).parameters
    total = -found[late].value
    if total > HELD * trace.sample_period:  # a voltage that is held: as exactly later as that makes it
        acting = trace.with_signals({"voltage": _held(trace, rig)}, {"voltage": "V"})
        found = by("voltage", acting).parameters
        total = 0.5 * trace.sample_period - found[late].value
    known = {name: found[own] for own, name in names.items() if own in found}
    if "kA" in known and "kV" in known:
        low, high = _electrical(total, trace.sample_period, rig)
        known["kA"] = _between(known["kA"], low * known["kV"].value, high * known["kV"].value)
    return known


def _by_samples(trace: Trace, rig: Rig, known: Mapping[str, Parameter]) -> dict[str, Parameter]:
    """kS, kV, kA - and kG - in place of those that derivatives gave."""
    found, delay = sampled(trace, rig, "kG" in known)
    by = {name: replace(one, unit=known[name].unit) for name, one in found.items()}
    low, high = _electrical(delay, trace.sample_period, rig)
    return by | {"kA": _between(by["kA"], low * by["kV"].value, high * by["kV"].value)}


def _samples_of(known: Mapping[str, Parameter], trace: Trace) -> float:
    """Samples of a recording in the time constant of its motor."""
    return known["kA"].value / known["kV"].value / trace.sample_period


def with_inertia(found: Estimate, trace: Trace, rig: Rig) -> Estimate:
    """The estimate of a recording with a voltage, its inertia with what a held voltage leaves uncertain."""
    name, per_volt = rig.axis_kind.inertia, _per_volt(trace, rig, found)
    by = None if per_volt is None or name not in found else _inertia(found, trace, rig, per_volt)
    if by is None:
        return found
    warnings = (*found.warnings, f"{words(name)}: {by[1]}")
    by_fit = {one: table for one, table in found.correlations.items() if one != name}
    return replace(found, parameters={**found.parameters, name: by[0]}, warnings=warnings, correlations=by_fit)


def _inertia(found: Estimate, trace: Trace, rig: Rig, per_volt: float) -> tuple[Parameter, str] | None:
    """The inertia by a voltage, with the reason; None where the one of the estimate is kept.

    It is that of kA where few samples make a time constant. Where they do not show kA, the interval covers a voltage
    that is held and one that is not. A current that is read at the end of each hold, by the voltage before it, is not
    the mean of its hold: the shift of the torque is then one of the part that is not induced alone.
    """
    assert found.motor is not None
    old, known, period = found[rig.axis_kind.inertia], found.motor.parameters, trace.sample_period
    if "current" in trace:
        shift = found[rig.axis_kind.parameter(MISALIGNMENT)]
        by = old.value + shift.ci95[int(shift.value > 0.0)] * known[BACK_EMF].value * per_volt
        if old.ci95[0] <= by <= old.ci95[1] or not _read_before(trace, rig):
            return None
        why = "the current is read before its voltage changes, and is not the mean between two samples"
        return old.reaching(by), f"{why}: it may be {by:.3g} {old.unit}; record at a higher rate"
    if "kA" in found.motor.refused and "kV" in known:
        least = old.value - 0.5 * period * known["kV"].value * per_volt
        return old.reaching(least), f"{least:.3g} {old.unit} if the voltage is held between samples; record more often"
    if "kA" not in known or (often := _samples_of(known, trace)) >= FEW:
        return None
    why = f"found from sample to sample, without derivatives, as the motor's time constant has {often:.2g} samples"
    return replace(known["kA"].times(per_volt), unit=old.unit), why


def _read_before(trace: Trace, rig: Rig) -> bool:
    """Whether the current follows from the voltage one sample before, as where a voltage is set after reading.

    A drive that controls its current has both at one time.
    """
    volts, speed, left = rig.voltage(trace), measured_velocity(trace), np.zeros(2)
    for part in trace.segments:
        if part.stop - part.start > LEAST:
            table = np.column_stack([trace["current"][part], speed[part], np.ones(part.stop - part.start)])[1:]
            for late in (0, 1):
                other = volts[part.start + 1 - late : part.stop - late]
                left[late] += float(np.sum((other - table @ np.linalg.lstsq(table, other, rcond=None)[0]) ** 2))
    return bool(left[1] < left[0])


def require_often(trace: Trace, rig: Rig, found: Estimate) -> None:
    """UndeterminedError where few samples make a time constant of the motor, by the estimate of its recording.

    What a current does while a voltage is held between them would pass for an effect. Where the voltage itself is the
    effort, its shift is fitted, and only the square of that remains.
    """
    if found.motor is None or _per_volt(trace, rig, found) is None or not _read_before(trace, rig):
        return
    known = found.motor.parameters
    often = _samples_of(known, trace) if "kA" in known else FEW * ("kA" not in found.motor.refused)
    if often >= FEW:
        return
    faster = f"at {FEW / often / trace.sample_period:.2g} Hz or more" if often else "at a higher rate"
    period = f"{1e3 * trace.sample_period:.3g} ms"
    reason = f"the voltage is held for the {period} between samples, in which the motor follows it"
    raise UndeterminedError("whether the model lacks an effect", reason, f"the motion {faster}")


def _per_volt(trace: Trace, rig: Rig, found: Estimate) -> float | None:
    """Effort of one volt, in the unit of the estimate; None where it does not follow a voltage."""
    motor, constant = rig.motor, rig.motor.torque_per_ampere
    if rig.axis_kind.effort in trace or found.motor is None:
        return None
    if "current" in trace:
        winding = found.motor.parameters.get(RESISTANCE)
        return None if winding is None else (constant.constant if constant else 1.0) / winding.value
    gain = motor.force_per_volt or motor.torque_per_volt
    return gain or (constant.constant / motor.resistance if constant and motor.resistance else 1.0)


def _held(trace: Trace, rig: Rig) -> Array:
    """A voltage that is held from each sample to the next, as it acts at the samples - V - (n,).

    Half a sample later, by a spline, and weaker by sin(x)/x = 1 - x**2/6 with x = w*T/2 for a period T.
    """
    voltage = rig.voltage(trace)
    later = voltage.copy()
    for part in trace.segments:
        if part.stop - part.start > 3:
            middle = splined(voltage[part], 2)[0][1::2]
            middle[1:-1] += np.diff(middle, 2) / 24.0
            later[part.start + 1 : part.stop] = middle
    return later


def _electrical(total: float, period: float, rig: Rig) -> tuple[float, float]:
    """Least and most of a delay of the motion behind the voltage that may be L/R of the winding - s.

    The rest is a delay of the voltage: a sample period at most, where that suffices.
    """
    motor, total = rig.motor, max(total, 0.0)
    stated = motor.electrical_time_constant
    if motor.inductance is not None and motor.resistance:
        stated = motor.inductance / motor.resistance
    if stated is not None:
        return min(stated, total), min(stated, total)
    return (total - period if period < total < period + LONGEST else 0.0), min(total, LONGEST)


def _between(found: Parameter, low: float, high: float) -> Parameter:
    """A parameter larger by something between two bounds, which its interval covers."""
    value, half = found.value + 0.5 * (low + high), found.half_width + 0.5 * abs(high - low)
    return Parameter.around(value, found.unit, half / NORMAL95, half)


def _weighted(rig: Rig) -> bool:
    """Whether a known weight pulls."""
    return rig.load is not None and rig.load.eccentric_mass is not None


def _scale(trace: Trace, rig: Rig, by: By) -> dict[str, Parameter]:
    """Torque (force) per current, from a known weight or inertia - N*m/A (N/A)."""
    kind, torque, share = rig.axis_kind, 1.0, 0.0
    name = f"{kind.effort}_constant"
    if _weighted(rig):
        per = _by_weight(trace, rig)
    elif rig.stated_inertia:
        found, winding = by("current", trace).parameters, _circuit(trace, rig, by)
        torque, shift = rig.stated_inertia, found[kind.parameter(MISALIGNMENT)].value
        # of the current as a whole, or only of the part that is not induced
        induced = winding[BACK_EMF].value / winding[RESISTANCE].value
        per = _between(found[kind.inertia], *sorted((0.0, induced * shift)))
        moved = [(one.stated_inertia or 0.0) / torque - 1.0 for one in rig.within_tolerance()]
        share = rms(np.array([*moved, 0.0])) * (len(moved) + 1) ** 0.5
    else:
        record = "the same, with the inertias of motor and load, or a weight (load.eccentric_mass), in the rig"
        raise UndeterminedError(name, f"neither an inertia nor a weight is known that scales the {kind.effort}", record)
    if not 0.0 < per.half_width < DETERMINED * per.value:
        raise UndeterminedError(name, f"the current that it takes is {per}", STEPS)
    value = torque / per.value
    low, high = (torque / bound for bound in reversed(per.ci95))
    found = Parameter(value, f"{kind.effort_unit}/A", value * per.std_error / per.value, (low, high))
    return {name: found.widened(share * value)}


def _by_weight(trace: Trace, rig: Rig) -> Parameter:
    """Current for the torque of a known weight - A/(N*m) -, fitted with inertia, friction and the sensor's zero."""
    assert rig.load is not None
    at, pull = condition(trace, trace["current"]), rig.load.gravity_torque(trace["position"])
    source = trace[at.source]
    sign = known_sign(raw_speed(source, at.source, trace.sample_period), at.sign_threshold)
    signals = pull, sign, np.ones(len(trace)), source, source, trace["current"], trace["current"]
    orders = 0, 0, 0, at.order, at.order + 1, 1, 0
    time, table = filtered(trace, at.filter, signals, orders)
    moving = np.abs(table[1]) > 1.0 - ONE_SIGN
    loud = 0.0, 0.0, 0.0, at.source_noise, at.source_noise, at.effort_noise
    noise = [(size * at.filter.noise_gain(order)) ** 2 for size, order in zip(loud, orders, strict=False)]
    return regressed(time[moving], table[:, moving], noise, at.effort_noise, at.filter)[0]


def _circuit(trace: Trace, rig: Rig, by: By) -> dict[str, Parameter]:
    """R and Ke, and one over Ke."""
    late = compared(Seen(trace)) if {"position", "velocity"} <= set(trace.signals) else None
    if late is not None and abs(late[1]) > 0.5 * trace.sample_period:
        trace = trace.without("velocity")  # which a filter of the drive makes late
    at, voltage, kind = condition(trace, trace["current"]), rig.voltage(trace), rig.axis_kind
    loud = at.effort_noise, at.source_noise, at.effort_noise
    noise = [(size * at.filter.noise_gain(order)) ** 2 for size, order in zip(loud, (0, at.order, 1), strict=True)]
    own = white_noise(*(voltage[part] for part in trace.segments))

    def fitted(volts: Array, lag: Array, known: float) -> list[Parameter]:
        """R, Ke and what a third signal's rate takes, of a noise - V, A - that is known."""
        signals = trace["current"], trace[at.source], lag, volts
        time, table = filtered(trace, at.filter, signals, (0, at.order, 1, 0))
        return regressed(time, table, [*noise[:2], known], own, at.filter)

    in_step = fitted(voltage, trace["current"], noise[2])
    total = in_step[2].value / max(in_step[0].value, 1e-300)
    acting = _held(trace, rig) if total > HELD * trace.sample_period else voltage
    held = fitted(acting, acting, 0.0)
    low, high = (part / total if total > 0.0 else 0.0 for part in _electrical(total, trace.sample_period, rig))
    names = {RESISTANCE: "ohm", BACK_EMF: f"V*s/{kind.length_unit}"}
    known = {}
    for (name, unit), one, other in zip(names.items(), held, in_step, strict=False):
        away = other.value - one.value
        known[name] = replace(_between(one, low * away, high * away), unit=unit)
    _require_motor(known)
    emf = known[BACK_EMF]
    low, high = (1.0 / bound for bound in reversed(emf.ci95))
    known[SPEED] = Parameter(1.0 / emf.value, f"{kind.length_unit}/(V*s)", emf.std_error / emf.value**2, (low, high))
    return known


def _require_motor(known: Mapping[str, Parameter]) -> None:
    """UndeterminedError where no motor has these constants, or a recording hardly determines one."""
    for name, found in known.items():
        if found.value <= 0.0:
            reason = f"{words(name)} would be {found}: a sign is wrong, or the current is the supply's"
            raise UndeterminedError(words(name), reason, "current and voltage of the motor, positive where it drives")
        if found.half_width > DETERMINED * found.value:
            raise UndeterminedError(words(name), f"{words(name)} would be {found}", STEPS)
