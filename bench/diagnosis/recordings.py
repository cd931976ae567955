"""The recordings of a diagnosis as rows of the torque balance, and whether they suffice to see what it lacks."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bench.arrays import Array, rms
from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.diagnosis.policy import POLICY
from bench.effects.acting import FilteredSignal
from bench.effects.catalogue import catalogue
from bench.effects.effect import Detectable, Detected, Effect
from bench.errors import InputError, UndeterminedError
from bench.fit.determined import require_friction, require_inertia
from bench.fit.fit import Fit, fit
from bench.fit.hum import with_hum
from bench.fit.hypothesis import lay_out, plain
from bench.fit.identify import TELLS, TERMS, steady
from bench.fit.quantities import Uncertain
from bench.fit.rows import Rows, clear_motion
from bench.fit.solution import equations_of, solution_of
from bench.parameter import Parameter
from bench.rig.rig import Rig
from bench.trace.filter import LEAST_WIDTH
from bench.trace.trace import Trace, join

#: Least number of independent rows of clear motion. Of shortened shared cases, those with 25 to 70 named an absent
#: effect in 5 of 11, those with 90 to 130 in 1 of 13 (first 0.2, 0.4 and 0.8 s of every other one).
INDEPENDENT = 100
#: An effect this many times smaller than the torque of the motion is small, however little friction there is.
SMALL = 10.0
#: Largest share of noise in the acceleration's power. Least squares underestimates inertia by it: by 27 % at 0.27, by 4
#: % at 0.04; the shared cases have 6e-5 at most.
NOISY = 0.1

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
    """

    rig: Rig
    trace: Trace
    corrected: Trace
    holdout: Trace | None
    rows: Rows
    holdout_rows: Rows | None
    detected: Mapping[Effect, Detected]
    doubt: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, trace: Trace | Sequence[Trace], rig: Rig, holdout: Trace | None) -> Recordings:
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
        rows = Rows.of(trace, rig)
        _require_decidable(trace, rig, rows)
        width = rows.conditioning.filter.width
        detected: dict[Effect, Detected] = {}
        for effect in catalogue().values():
            found = effect.detect(trace, rig, width) if isinstance(effect, Detectable) else None
            if found is not None:
                detected[effect] = found
        corrected, unseen = trace, holdout
        for effect, found in detected.items():
            if isinstance(effect, FilteredSignal) and effect.signal == rows.conditioning.source:
                corrected = _corrected(corrected, rig, effect, found)
                unseen = None if unseen is None else _corrected(unseen, rig, effect, found)
        if corrected is not trace:
            rows = Rows.of(corrected, rig)
            _require_decidable(corrected, rig, rows)
        width, peak = rows.conditioning.filter.width, rows.scope.peak_effort
        holdout_rows = None if unseen is None else Rows.of(unseen, rig, width=width, peak_effort=peak)
        return cls(rig, trace, corrected, holdout, rows, holdout_rows, detected)

    def within_tolerance(self, fitted: Fit) -> list[Fit]:
        """A balance of the whole recording, refitted with each of the rig's values at the end of its tolerance."""
        if fitted.rows is not self.rows:
            return []
        same = self.rows.conditioning
        rigs = self.rig.within_tolerance()
        return [fit(Rows.of(self.corrected, rig, conditioning=same), fitted.hypothesis) for rig in rigs]

    def steady(self, found: Fit) -> tuple[Recordings, tuple[str, ...]]:
        """The same at the cut-off at which J, K_w and K_0 stand still beside the effects of a fit, and what moved.

        Asked among the links of a robot: the noise and lags of other joints' speeds enter at high frequency, and what
        is left of the inertia beside the links' is a small difference.
        """
        if not found.rows.stretches[0].signals.known:
            return self, ()
        calm, chosen = steady(solution_of(found.rows, found.hypothesis, self.rig.offset), self.rig)
        doubt = dict(zip(TERMS, chosen.doubt.tolist(), strict=True))
        moves = tuple(warning.removesuffix(f"; {TELLS}") for warning in chosen.warnings)
        if calm.rows is found.rows:
            return replace(self, doubt=doubt), moves
        smooth, unseen = calm.rows.conditioning.filter, self.holdout_rows
        unseen = None if unseen is None else unseen.through(smooth)
        return replace(self, rows=calm.rows, holdout_rows=unseen, doubt=doubt), moves

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
    """The fit of no effect, beside the hum of the mains: what it leaves is the gap."""
    return with_hum(fit(rows, plain(rows)))


def _corrected(trace: Trace, rig: Rig, effect: FilteredSignal, found: Detected) -> Trace:
    """A recording with a fault of its sensor corrected; without the faulty signal if that cannot be corrected."""
    if found.mends or rig.needs_speed(trace):
        return effect.corrected(trace, found.values)
    return trace.without(effect.signal)


def _require_samples(trace: Trace) -> None:
    """Refuse a recording of which even the narrowest filter leaves too few independent rows."""
    needed = math.ceil(INDEPENDENT * 2.0 * math.sqrt(math.pi) * LEAST_WIDTH)
    if len(trace) < needed:
        raise UndeterminedError(
            WHAT,
            f"{trace.origin} holds {len(trace)} samples, {len(trace) * trace.sample_period:.2g} s",
            f"at this rate {needed * trace.sample_period:.2g} s at least, better ten times that, "
            "in both directions with several reversals",
        )


def _require_another(trace: Trace, holdout: Trace) -> None:
    """Refuse a holdout that is the recording itself."""
    if len(trace) == len(holdout) and all(
        name in holdout and np.array_equal(values, holdout[name]) for name, values in trace.signals.items()
    ):
        raise InputError("holdout", f"found the recording itself ({holdout.origin})", "allowed: another recording")


def _require_decidable(trace: Trace, rig: Rig, rows: Rows) -> None:
    """Refuse a recording that is too short, too quiet, or whose rows determine no inertia and friction."""
    conditioning, found = rows.conditioning, rows.effort.size / rows.correlation
    if found < INDEPENDENT:
        moving = rows.effort.size * conditioning.filter.stride * conditioning.filter.sample_period
        raise UndeterminedError(
            WHAT,
            f"{moving:.2g} s of {trace.time[-1] - trace.time[0]:.3g} s move clearly in one direction, "
            f"{found:.0f} independent samples where {INDEPENDENT} are needed",
            f"at least {moving * INDEPENDENT / found:.2g} s of such motion in both directions: "
            f"{clear_motion(conditioning, trace.axis_kind)}",
        )
    equations = equations_of(rows, lay_out(rows, plain(rows)))
    require_inertia(equations, rig.axis_kind)
    require_friction(equations, rig.axis_kind)
    base, unit = fit(rows, plain(rows)), rig.axis_kind.acceleration_unit
    noise, moved = conditioning.acceleration_noise, rms(base.columns[:, base.owners == INERTIA])
    if noise**2 > NOISY * moved**2:
        raise UndeterminedError(
            WHAT,
            f"acceleration is {moved:.3g} {unit} RMS, {noise:.3g} {unit} of it noise of {conditioning.source}",
            f"accelerations above {noise / math.sqrt(NOISY):.3g} {unit} RMS, or a finer {conditioning.source}",
        )
    _require_above_noise(base, rig.net_effort(trace)[1])


def _require_above_noise(base: Fit, unit: str) -> None:
    """Refuse a recording whose noise would hide an effect as large as friction, or as a tenth of the torque."""
    conditioning = base.rows.conditioning
    noise = conditioning.effort_noise * conditioning.filter.noise_gain(0)
    varies = float(np.std(base.effort))
    if varies <= 2.0 * noise:
        raise UndeterminedError(
            WHAT,
            f"the motor torque varies by {varies:.3g} {unit}, its noise alone by {noise:.3g} {unit}",
            f"a motion that takes more than {4.0 * noise:.2g} {unit} to accelerate and brake"
            if noise > 0.0
            else "the signal that the motor's torque follows: this one never changes",
        )
    friction, torque = (
        rms(base.columns[:, places] @ base.theta[places])
        for places in (np.isin(base.owners, terms) for terms in ((VISCOUS, COULOMB), (INERTIA, VISCOUS, COULOMB)))
    )
    least = math.sqrt(POLICY.by_chance(base, 1) / base.effort.size)
    loud = max(friction, torque / SMALL)
    if least > loud:
        raise UndeterminedError(
            WHAT,
            f"only effects above {least:.3g} {unit} would stand out of the noise, friction is {friction:.3g} {unit} "
            f"and the torque {torque:.3g} {unit}",
            f"{LONGER * (least / loud) ** 2:.2g} times as long, or accelerations {LONGER * least / loud:.2g} times as "
            "large",
        )
