"""The state of an axis from recordings, by `identify` alone or by `diagnose` too."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.arrays import rms
from bench.baseline.state import TORQUE_GAP, VELOCITY_GAP, AxisEffect, DetectionLimits, RemainingGap, State
from bench.comparison.difference import Measured
from bench.diagnosis.diagnosis import Diagnosis, diagnose
from bench.diagnosis.name import NamedEffect
from bench.diagnosis.policy import POLICY
from bench.diagnosis.recordings import Recordings
from bench.fit.estimate import Estimate
from bench.fit.fit import Fit, fit, shaped
from bench.fit.hum import with_hum
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.identify import identify
from bench.fit.quantities import uncertain
from bench.fit.rows import WIDEST, Rows
from bench.gate.gate import passed
from bench.parameter import Parameter
from bench.rig.rig import Rig
from bench.rig.values import tolerance_of
from bench.trace.motion import measured_velocity
from bench.trace.trace import Trace, join

Progress = Callable[[float], None]

#: Factor within which conditions count as equal.
ALIKE = 1.1
#: Recorded but not compared: a changed axis needs another effort, and the cut-off follows the noise.
FOLLOWING = frozenset({"rms_effort", "cutoff"})
#: Window over which speed is averaged before it is differentiated - s.
SMOOTH = 0.02
#: Keys of a rig that no result depends on; the drive's effect on the motion is compared separately.
BESIDE = {"name", "simulation", "check", "drive", "source"}


@dataclass(frozen=True)
class Observed:
    """A state and, where effects were searched for, the torque balance with them, through the filter of all states."""

    state: State
    fitted: Fit | None = None

    def under(self, others: Sequence[tuple[AxisEffect, AxisEffect | None]]) -> State:
        """The state with the effects of another one in the torque balance, each with its match in this one, refitted.

        An effect that comes or goes changes J, K_w and K_0 with it: an unchanged axis agrees under both sets. Effects
        without a match here start from the shape they had there; those outside the torque balance are left out.
        """
        own, unit = self.fitted, self.state.quantities[TORQUE_GAP].unit
        assert own is not None
        shaped_here = [one for one in self.state.effects if one.shape is not None]
        held = [pair for pair in others if pair[0].shape is not None]
        terms = []
        for effect, mine in held:
            if mine is not None:
                terms.append(own.terms[shaped_here.index(mine)])
            else:
                terms.append(Term(effect.effect, effect.shape or (), effect.on_load))
        fitted = fit(own.rows, own.hypothesis.with_terms(terms), own)
        for index, (_, mine) in enumerate(held):
            if mine is None:
                fitted = shaped(fitted, fitted.hypothesis, index)
        base = uncertain(fitted).base(self.state.kind.base_parameters(unit))
        effects = [replace(effect, torque=_torque(fitted, index, unit)) for index, (effect, _) in enumerate(held)]
        quantities = _measured(base) | {TORQUE_GAP: _torque_gap(fitted, unit)}
        gaps = {"torque": _remaining(fitted.rms, fitted.floor, unit)}
        return replace(self.state, quantities=quantities, effects=tuple(effects), gaps=gaps)


def observe(
    trace: Trace | Sequence[Trace], rig: Rig, names: bool = True, progress: Progress = lambda share: None
) -> Observed:
    """The state of an axis now.

    Args:
        trace: a recording, or a list of several.
        rig: of the axis.
        names: whether effects are searched for, which takes seconds; else only parameters and residual.
        progress: called with the share done.

    Raises:
        UndeterminedError: the recordings do not determine a parameter.
        InputError: rig and recording do not fit together.
    """
    traces = [trace] if isinstance(trace, Trace) else list(trace)
    if names:
        return _diagnosed(traces, rig, progress)
    traces = [passed(trace, rig).trace for trace in traces]
    found, fitted = identify(traces, rig), balance(join(traces), rig, Hypothesis())
    quantities = _quantities(found, fitted, rig, found.residual.unit)
    gaps = {"torque": _remaining(fitted.rms, fitted.floor, found.residual.unit)}
    at = conditions(traces, rig, found.cutoff)
    return Observed(State("recordings", False, quantities, gaps=gaps, conditions=at, rig=rig_values(rig)))


def _diagnosed(traces: Sequence[Trace], rig: Rig, progress: Progress) -> Observed:
    """State by `diagnose`: parameters together with named effects, gaps and verdict."""
    found = diagnose(traces, rig, progress=progress)
    traces = [passed(trace, rig).trace for trace in traces]
    recordings = Recordings.of(traces, rig, None)
    unit, fitted = recordings.unit, balance(recordings.corrected, rig, replace(found.balance.hypothesis, hum=()))
    count = len(fitted.terms)
    effects = [_named(effect, fitted, index, unit) for index, effect in enumerate(found.effects[:count])]
    effects += [AxisEffect(e.effect, quantities=_measured(e.parameters)) for e in found.effects[count:]]
    gaps = {
        name: _remaining(gap.identify[1], gap.noise_floor, gap.unit)
        for name, gap in (("torque", found.torque), ("velocity", found.velocity))
        if gap.identify is not None
    }
    quantities = _quantities(found, fitted, rig, unit)
    if "velocity" in gaps:
        quantities[VELOCITY_GAP] = gaps["velocity"].after
    state = State(
        source="recordings",
        names=True,
        quantities=quantities,
        effects=tuple(effects),
        verdict=found.verdict,
        gaps=gaps,
        shows=_shows(fitted, unit),
        conditions=conditions(traces, rig, recordings.rows.conditioning.filter.cutoff),
        rig=rig_values(rig),
    )
    return Observed(state, fitted)


def balance(trace: Trace, rig: Rig, hypothesis: Hypothesis) -> Fit:
    """The torque balance of a recording through the common filter of all states.

    The filter that a recording would choose by itself depends on its noise, and noise and torque of an effect behind it
    depend on the filter: such states would not be comparable.
    """
    return with_hum(fit(Rows.of(trace, rig, width=WIDEST), hypothesis))


def _quantities(found: Estimate | Diagnosis, fitted: Fit, rig: Rig, unit: str) -> dict[str, Measured]:
    """J, K_w and K_0 with how recordings differ in them, and the residual of the torque balance."""
    names = [name for name in rig.axis_kind.base_parameters() if name in found.parameters]
    alone = {name: [one.parameters[name] for one in found.recordings if name in one.parameters] for name in names}
    known = {name: Measured.of(found.parameters[name], alone[name]) for name in names}
    return known | {TORQUE_GAP: _torque_gap(fitted, unit)}


def _measured(parameters: Mapping[str, Parameter]) -> dict[str, Measured]:
    return {name: Measured.of(one) for name, one in parameters.items()}


def _remaining(after: float, noise_floor: float, unit: str) -> RemainingGap:
    return RemainingGap(Measured(after, unit), Measured(noise_floor, unit))


def _named(found: NamedEffect, fitted: Fit, index: int, unit: str) -> AxisEffect:
    term, torque = fitted.terms[index], _torque(fitted, index, unit)
    return AxisEffect(
        effect=found.effect,
        quantities=_measured(found.parameters),
        shape=term.shape,
        on_load=term.on_load,
        torque=torque,
        ambiguous_with=found.ambiguous_with,
        gain=(torque.value / torque.std_error) ** 2,
    )


def _torque(fitted: Fit, index: int, unit: str) -> Measured:
    """RMS torque of a term that the rest of the model cannot explain.

    Its square is the reduction of the mean squared residual by the term; its error is that of one amplitude fitted to
    the rows, of which only some are independent after the filter.
    """
    less = fit(fitted.rows, fitted.hypothesis.without(index), fitted)
    saved = max(less.squares - fitted.squares, 0.0) / fitted.count
    error = fitted.floor * np.sqrt(fitted.rows.correlation / fitted.count)
    return Measured(float(np.sqrt(saved)), unit, float(error))


def _torque_gap(fitted: Fit, unit: str) -> Measured:
    """RMS residual r with its standard error, r/sqrt(2*n) with n independent rows behind the filter."""
    independent = fitted.count / fitted.rows.correlation
    return Measured(fitted.rms, unit, float(fitted.rms / np.sqrt(2.0 * independent)))


def _shows(fitted: Fit, unit: str) -> DetectionLimits:
    """Torque that is significant in a recording, and that its residual may hide as noise, up to `Policy.remainder`."""
    significant = POLICY.by_chance(fitted, 1) / fitted.count
    hidden = max(fitted.chi, POLICY.remainder) ** 2 - 1.0
    return DetectionLimits(
        Measured(math.sqrt(significant), unit), Measured(float(fitted.floor * math.sqrt(hidden)), unit)
    )


def conditions(traces: Sequence[Trace], rig: Rig, cutoff: float) -> dict[str, Measured]:
    """Motion, sampling and cut-off - Hz - of recordings, their mean where there are several; SI."""
    kind = rig.axis_kind
    units = {
        "top_speed": kind.speed_unit,
        "rms_speed": kind.speed_unit,
        "rms_acceleration": kind.acceleration_unit,
        "rms_effort": rig.net_effort(traces[0])[1],
        "duration": "s",
        "sample_period": "s",
    }
    found = np.mean([_conditions_of(trace, rig) for trace in traces], axis=0).tolist()
    measured = {name: Measured(value, unit) for (name, unit), value in zip(units.items(), found, strict=True)}
    return measured | {"cutoff": Measured(cutoff, "Hz")}


def _conditions_of(trace: Trace, rig: Rig) -> list[float]:
    speed, period = measured_velocity(trace), trace.sample_period
    width = max(1, round(SMOOTH / period))
    slopes = [np.zeros(1)]
    for part in trace.segments:
        if part.stop - part.start > 2 * width:
            smooth = np.convolve(speed[part], np.full(width, 1.0 / width), "valid")
            slopes.append(np.gradient(smooth, period))
    top = float(np.quantile(np.abs(speed), 0.99))  # robust against one glitch
    duration = float(trace.time[-1] - trace.time[0])
    return [top, rms(speed), rms(np.concatenate(slopes)), rms(rig.net_effort(trace)[0]), duration, period]


def motion_ratio(baseline: Mapping[str, Measured], now: Mapping[str, Measured]) -> float:
    """The largest factor, 1 or above, by which a condition differs; inf where one is zero in one of the two only."""
    pairs = [(baseline[name].value, now[name].value) for name in baseline if name in now and name not in FOLLOWING]
    return max((max(pair) / min(pair) if min(pair) > 0.0 else math.inf for pair in pairs if any(pair)), default=1.0)


def unlike(baseline: Mapping[str, Measured], now: Mapping[str, Measured]) -> list[str]:
    """A line for each condition that differs."""
    lines = []
    for name in (name for name in baseline if name in now and name not in FOLLOWING):
        before, after = baseline[name].value, now[name].value
        if not before / ALIKE <= after <= before * ALIKE:
            lines.append(f"{name.replace('_', ' ')}: {before:.4g} -> {after:.4g} {baseline[name].unit}")
    return lines


def rig_values(rig: Rig) -> dict[str, str]:
    """The keys that identification reads of a rig, dotted, with their values as text in SI."""
    found = dict(_flat("", rig.model_dump(exclude=BESIDE)))
    if rig.drive is not None:
        found["drive.control_period"] = _text(rig.drive.control_period)
    return found


def _flat(place: str, value: object) -> Iterator[tuple[str, str]]:
    """Values of tables within tables that are given, each with its place."""
    if isinstance(value, Mapping):
        for key, part in value.items():
            yield from _flat(f"{place}.{key}" if place else key, part)
    elif isinstance(value, list | tuple):
        for number, part in enumerate(value):
            yield from _flat(f"{place}[{number}]", part)
    elif value is not None:
        yield place, _text(value)


def _text(value: object) -> str:
    if not isinstance(value, float):
        return str(value)
    tolerance = tolerance_of(value)
    return f"{float(value):.9g} +/- {tolerance:.3g}" if tolerance else f"{value:.9g}"


def differing(baseline: Mapping[str, str], now: Mapping[str, str]) -> list[str]:
    """A line for each key of two rigs that differs."""
    return [
        f"{key}: {baseline.get(key, 'not given')} -> {now.get(key, 'not given')}"
        for key in dict.fromkeys([*baseline, *now])
        if baseline.get(key) != now.get(key)
    ]
