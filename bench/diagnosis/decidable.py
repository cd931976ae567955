"""The bare fit - inertia, viscous and Coulomb friction - and whether a recording suffices to see what it lacks."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from bench.arrays import Array, rms
from bench.axis_kind import COULOMB, INERTIA, VISCOUS, AxisKind
from bench.diagnosis.policy import POLICY
from bench.errors import InputError, UndeterminedError
from bench.fit.determined import require_friction, require_inertia
from bench.fit.fit import Fit, fit
from bench.fit.hum import with_hum
from bench.fit.layout import lay_out, plain
from bench.fit.rows import Rows, clear_motion
from bench.fit.solution import equations_of
from bench.rig.rig import Rig
from bench.trace.filter import LEAST_WIDTH
from bench.trace.trace import Trace

#: Least number of independent rows of clear motion. Of shortened shared cases, those with 25 to 70 named an absent
#: effect in 5 of 11, those with 90 to 130 in 1 of 13 (first 0.2, 0.4 and 0.8 s of every other one).
INDEPENDENT = 100
#: An effect this many times smaller than the torque of the motion is small, however little friction there is.
SMALL = 10.0
#: Largest share of noise in the acceleration's power. Least squares underestimates inertia by it: by 27 % at 0.27, by 4
#: % at 0.04; the shared cases have 6e-5 at most.
NOISY = 0.1

WHAT = "whether the model lacks an effect"


def fit_bare(rows: Rows) -> Fit:
    """The fit of no effect, beside the hum of the mains: what it leaves is the gap."""
    return with_hum(fit(rows, plain(rows)))


def require_samples(trace: Trace) -> None:
    """Raise UndeterminedError if even the narrowest filter leaves too few independent rows of the recording."""
    needed = math.ceil(INDEPENDENT * 2.0 * math.sqrt(math.pi) * LEAST_WIDTH)
    if len(trace) < needed:
        raise UndeterminedError(
            WHAT,
            f"{trace.origin} holds {len(trace)} samples, {len(trace) * trace.sample_period:.2g} s",
            f"at this rate {needed * trace.sample_period:.2g} s at least, better ten times that, "
            "in both directions with several reversals",
        )


def require_another(trace: Trace, holdout: Trace) -> None:
    """Raise InputError if the holdout is the recording itself."""
    if len(trace) == len(holdout) and all(
        name in holdout and np.array_equal(values, holdout[name]) for name, values in trace.signals.items()
    ):
        raise InputError("--holdout", f"found the recording itself ({holdout.origin})", "allowed: another recording")


def require_decidable(trace: Trace, rig: Rig, rows: Rows) -> Fit:
    """Refuse a recording that is too short, too quiet, or whose rows determine no inertia and friction.

    Returns:
        The fit of the empty hypothesis.

    Raises:
        UndeterminedError: with what to record instead.
    """
    _require_length(trace, rows)
    equations = equations_of(rows, lay_out(rows, plain(rows)))
    require_inertia(equations, rig.axis_kind)
    require_friction(equations, rig.axis_kind)
    bare = fit(rows, plain(rows))
    _require_audible(bare, rig.net_effort(trace)[1], rig.axis_kind)
    return bare


def _require_length(trace: Trace, rows: Rows) -> None:
    smooth = rows.conditioning.filter
    correlation = rows.correlation
    found = rows.effort.size / correlation
    if found >= INDEPENDENT:
        return
    moving = rows.effort.size * smooth.stride * smooth.sample_period
    raise UndeterminedError(
        WHAT,
        f"{moving:.2g} s of {trace.time[-1] - trace.time[0]:.3g} s move clearly in one direction, "
        f"{found:.0f} independent samples where {INDEPENDENT} are needed",
        f"at least {moving * INDEPENDENT / found:.2g} s of such motion in both directions: "
        f"{clear_motion(rows.conditioning, trace.axis_kind)}",
    )


def _require_audible(base: Fit, unit: str, kind: AxisKind) -> None:
    """Raise UndeterminedError if noise would hide an effect as large as friction, or as a tenth of the torque.

    Args:
        base: inertia, viscous and Coulomb friction fitted to the recording.
        unit: of the effort.
        kind: of the axis.
    """
    conditioning = base.rows.conditioning
    _require_acceleration(base, kind)
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
    friction, torque = (rms(_torque(base, terms)) for terms in ((VISCOUS, COULOMB), (INERTIA, VISCOUS, COULOMB)))
    least = math.sqrt(POLICY.by_chance(base, 1) / base.effort.size)
    loud = max(friction, torque / SMALL)
    if least > loud:
        raise UndeterminedError(
            WHAT,
            f"only effects above {least:.3g} {unit} would stand out of the noise, friction is {friction:.3g} {unit} "
            f"and the torque {torque:.3g} {unit}",
            f"{(least / loud) ** 2:.2g} times as long, or accelerations {least / loud:.2g} times as large",
        )


def _torque(base: Fit, terms: Sequence[str]) -> Array:
    """Modelled torque of some terms - N*m (N) - (m,)."""
    places = np.isin(base.owners, terms)
    return base.columns[:, places] @ base.theta[places]


def _require_acceleration(base: Fit, kind: AxisKind) -> None:
    conditioning = base.rows.conditioning
    noise, moved = conditioning.acceleration_noise, rms(base.columns[:, base.owners == INERTIA])
    if noise**2 <= NOISY * moved**2:
        return
    unit = kind.acceleration_unit
    raise UndeterminedError(
        WHAT,
        f"acceleration is {moved:.3g} {unit} RMS, {noise:.3g} {unit} of it noise of {conditioning.source}",
        f"accelerations above {noise / math.sqrt(NOISY):.3g} {unit} RMS, or a finer {conditioning.source}",
    )
