"""The recordings of a diagnosis as rows of the torque balance, and whether they suffice to see what it lacks."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice

import numpy as np

from bench.arrays import Array, rms
from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.diagnosis.policy import POLICY, Policy
from bench.effects.catalogue import catalogue
from bench.effects.effect import Detected, Effect, Lag
from bench.errors import InputError, UndeterminedError
from bench.fit.cutoffs import INDEPENDENT, NOISY, TELLS, TERMS, Tried, for_effects, for_inertia
from bench.fit.determined import RECORD, require_friction, require_inertia
from bench.fit.fit import Fit, fit
from bench.fit.hum import with_hum
from bench.fit.hypothesis import plain
from bench.fit.quantities import Uncertain
from bench.fit.rows import Rows, clear_motion, sign_reach
from bench.fit.solution import Solution, solution_of
from bench.names import percent
from bench.parameter import Parameter
from bench.rig.rig import Rig
from bench.trace.filter import LEAST_WIDTH
from bench.trace.trace import Trace, join

#: An effect this many times smaller than the torque of the motion is small, however little friction there is.
SMALL = 10.0
#: What is advised beyond what would just suffice.
LONGER = 1.5

WHAT = "whether the model lacks an effect"


@dataclass(frozen=True)
class Recordings:
    """Input of a diagnosis.

    Attributes:
        rig: of the axis.
        trace: the recording, or several joined.
        corrected: the same with faults of its sensors corrected, as it is fitted.
        holdout: another recording, not fitted; None without one.
        rows, holdout_rows: rows of both, without those faults.
        detected: effects outside the torque balance that the signals show directly.
        doubt: half widths of J, K_w and K_0 at 95 % from how they move with the filter's cut-off, by their terms.
        warnings: what noise of the motion hides.
    """

    rig: Rig
    trace: Trace
    corrected: Trace
    holdout: Trace | None
    rows: Rows
    holdout_rows: Rows | None
    detected: Mapping[Effect, Detected]
    doubt: Mapping[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    @classmethod
    def of(cls, trace: Trace | Sequence[Trace], rig: Rig, holdout: Trace | None, policy: Policy = POLICY) -> Recordings:
        """Rows of the recordings and of the holdout, after faults that the signals show directly are corrected.

        Raises:
            UndeterminedError: the recording is too short, too slow or too quiet to decide.
            InputError: rig and recording do not fit together, or the holdout is the recording itself.
        """
        traces = [trace] if isinstance(trace, Trace) else trace
        for each in (*traces, *([] if holdout is None else [holdout])):
            _require_samples(each)
        trace = join(traces)
        if holdout is not None:
            for each in traces:
                _require_another(each, holdout)
        rows, hidden = _decidable(trace, rig, policy)
        width = rows.conditioning.filter.width
        detected: dict[Effect, Detected] = {}
        for effect in catalogue().values():
            found = effect.detect(trace, rig, width)
            if found is not None:
                detected[effect] = found
        corrected, unseen = trace, holdout
        for effect, found in detected.items():
            if isinstance(effect, Lag) and effect.signal == rows.conditioning.source:
                corrected = _corrected(corrected, rig, effect, found)
                unseen = None if unseen is None else _corrected(unseen, rig, effect, found)
        if corrected is not trace:
            rows, hidden = _decidable(corrected, rig, policy)
        width, peak = rows.conditioning.filter.width, rows.scope.peak_effort
        holdout_rows = None if unseen is None else Rows.of(unseen, rig, width=width, peak_effort=peak, near=True)
        return cls(rig, trace, corrected, holdout, rows, holdout_rows, detected, warnings=hidden)

    def within_tolerance(self, fitted: Fit) -> list[Fit]:
        """A balance of the whole recording, refitted with each of the rig's values at the end of its tolerance."""
        if fitted.rows is not self.rows:
            return []
        same, near = self.rows.conditioning, self.rows.near
        rigs = self.rig.within_tolerance()
        rows = (Rows.of(self.corrected, rig, conditioning=same, near=near) for rig in rigs)
        return [fit(each, fitted.hypothesis, fitted) for each in rows]

    def like(self, rows: Rows) -> Recordings:
        """The same with other rows of the recording, and those of the holdout through the same filter."""
        unseen = self.holdout_rows
        unseen = None if unseen is None else unseen.through(rows.conditioning.filter, rows.near)
        return replace(self, rows=rows, holdout_rows=unseen)

    def lower(self) -> Iterator[Recordings]:
        """The same at the lower cut-offs that suit effects, too, from high to low."""
        lower = islice(_suited(self.rows, self.rig), 1, None)
        return (self.like(found.rows) for found in lower)

    def steady(self, found: Fit, policy: Policy) -> tuple[Recordings, tuple[str, ...]]:
        """The same at the cut-off at which J, K_w and K_0 no longer change with the effects of a fit, and what moved.

        Among the links of a robot: the noise and lags of other joints' speeds enter at high frequency, and the rotor's
        inertia is a small difference. On a lone axis whose residual is mostly noise of the motion, what moves from here
        to there is in their intervals: that noise, which biases J, is known to some per cent.
        """
        known = found.rows.stretches[0].signals.known
        if not known and not policy.noise_hides(found):
            return self, ()
        highest = solution_of(found.rows, found.hypothesis, self.rig.offset)
        calm, (moved, warnings) = for_inertia(highest, self.rig)
        if not known:
            here, there = (Tried.of(one, self.rig.axis_kind).theta for one in (highest, calm))
            moved, warnings, calm = np.nan_to_num(np.abs(there - here)), (), highest
        doubt = dict(zip(TERMS, moved.tolist(), strict=True))
        moves = tuple(warning.removesuffix(f"; {TELLS}") for warning in warnings)
        return replace(self if calm.rows is found.rows else self.like(calm.rows), doubt=doubt), moves

    def base(self, numbers: Uncertain) -> dict[str, Parameter]:
        """J, K_w and K_0 of a fit by name, as wide as they move with the cut-off."""
        values = zip((INERTIA, VISCOUS, COULOMB), numbers.base(self.base_units).items(), strict=True)
        return {name: found.widened(self.doubt.get(term, 0.0)) for term, (name, found) in values}

    @property
    def unit(self) -> str:
        """Unit of the effort: N*m, N, or what the rig allows."""
        return self.rig.net_effort(self.trace)[1]

    @property
    def current(self) -> Array | None:
        """Recorded current at the rows - A - (m,); None if another effort was recorded."""
        return self.corrected["current"][self.rows.samples()] if "current" in self.corrected else None

    @property
    def base_units(self) -> dict[str, str]:
        """Names of J, K_w and K_0 on this kind of axis, with their units."""
        return self.rig.axis_kind.base_parameters(self.unit)


def fit_bare(rows: Rows) -> Fit:
    """The fit of no effect, with the mains interference: its residual is the gap."""
    return with_hum(fit(rows, plain(rows)))


def _corrected(trace: Trace, rig: Rig, effect: Lag, found: Detected) -> Trace:
    """A recording with a fault of its sensor corrected; without the faulty signal if that cannot be corrected."""
    if found.mends or rig.needs_speed(trace):
        return effect.corrected(trace, found.values)
    return trace.without(effect.signal)


def _require_samples(trace: Trace) -> None:
    """Refuse a recording of which even the narrowest filter keeps too few independent rows."""
    needed = math.ceil(INDEPENDENT * 2.0 * math.sqrt(math.pi) * LEAST_WIDTH)
    if len(trace) < needed:
        raise UndeterminedError(
            WHAT,
            f"{trace.origin} contains {len(trace)} samples, {len(trace) * trace.sample_period:.2g} s",
            f"at this rate {needed * trace.sample_period:.2g} s at least, better ten times that, "
            "in both directions with several reversals",
        )


def _require_another(trace: Trace, holdout: Trace) -> None:
    """Refuse a holdout that is the recording itself."""
    if len(trace) == len(holdout) and all(
        name in holdout and np.array_equal(values, holdout[name]) for name, values in trace.signals.items()
    ):
        raise InputError("holdout", f"found the recording itself ({holdout.origin})", "allowed: another recording")


def _decidable(trace: Trace, rig: Rig, policy: Policy) -> tuple[Rows, tuple[str, ...]]:
    """Rows at the cut-off that suits effects best, and a warning of what a lower one than usual hides.

    UndeterminedError where the recording is too short or too quiet, or determines no inertia and friction.
    """
    usual, kind = Rows.of(trace, rig, near=True), rig.axis_kind
    if usual.independent < INDEPENDENT:
        smooth, whole = usual.conditioning.filter, float(trace.time[-1] - trace.time[0])
        moving = usual.effort.size * smooth.stride * smooth.sample_period
        needed = f"{usual.independent:.0f} independent samples where {INDEPENDENT} are needed"
        ends = 2 * smooth.margin * smooth.sample_period
        lengths = ((part.stop - part.start) * smooth.sample_period - ends for part in trace.segments)
        filtered = sum(length for length in lengths if length > 0.0)
        if usual.independent * (whole - ends) > INDEPENDENT * filtered:  # as many without holes
            reason = f"with holes between samples {filtered:.2g} s of {whole:.3g} s can be filtered, {needed}"
            raise UndeterminedError(WHAT, reason, "the same motion without holes")
        raise UndeterminedError(
            WHAT,
            f"{moving:.2g} s of {whole:.3g} s move clearly in one direction, {needed}",
            f"at least {moving * INDEPENDENT / usual.independent:.2g} s of such motion in both directions: "
            f"{clear_motion(usual.conditioning, trace.axis_kind)}",
        )
    source, found = usual.conditioning.source, next(_suited(usual, rig), None)
    if found is None:
        raise UndeterminedError(
            WHAT,
            f"noise of the {source} is more than {percent(NOISY)} of the acceleration's power at every cut-off of the "
            f"filter that keeps {INDEPENDENT} independent samples",
            f"{RECORD[INERTIA]}, or a finer {source}",
        )
    rows, smooth = found.rows, found.rows.conditioning.filter
    require_inertia(found.whole, kind)
    require_friction(found.whole, kind)
    _require_above_noise(fit(rows, plain(rows)), rig.net_effort(trace)[1], policy)
    if rows is usual:
        return rows, ()
    return rows, (
        f"noise of the {source} requires a filter of {smooth.cutoff:.3g} Hz: it hides resonances above that, and "
        f"friction within {sign_reach(smooth, near=True):.2g} s of a reversal; a finer {source} shows them",
    )


def _suited(rows: Rows, rig: Rig) -> Iterator[Solution]:
    """Solutions without effects at the cut-offs that suit effects, from high to low."""
    return for_effects(solution_of(rows, plain(rows), rig.offset), rig)


def _require_above_noise(base: Fit, unit: str, policy: Policy) -> None:
    """Refuse a recording whose noise would hide an effect as large as friction, or as a tenth of the torque."""
    conditioning = base.rows.conditioning
    noise = conditioning.effort_noise * conditioning.filter.noise_gain(0)
    varies = float(np.std(base.effort))
    if varies <= 2.0 * noise:
        raise UndeterminedError(
            WHAT,
            f"the motor torque varies by {varies:.3g} {unit}, its noise by {noise:.3g} {unit}",
            f"a motion that takes more than {4.0 * noise:.2g} {unit} to accelerate and brake"
            if noise > 0.0
            else "the signal that the motor's torque follows: this one never changes",
        )
    friction, torque = (
        rms(base.columns[:, places] @ base.theta[places])
        for places in (np.isin(base.owners, terms) for terms in ((VISCOUS, COULOMB), (INERTIA, VISCOUS, COULOMB)))
    )
    least = math.sqrt(policy.by_chance(base) / base.effort.size)
    loud = max(friction, torque / SMALL)
    if least > loud:
        raise UndeterminedError(
            WHAT,
            f"only effects above {least:.3g} {unit} would exceed the noise, friction is {friction:.3g} {unit} "
            f"and the torque {torque:.3g} {unit}",
            f"{LONGER * (least / loud) ** 2:.2g} times as long, or accelerations {LONGER * least / loud:.2g} times as "
            "large",
        )
