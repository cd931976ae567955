"""Doubt the names that a search found: what else speaks against them, though they explain?

The nearest effect of a catalogue explains a part of anything. A name goes where the holdout does not bear its event
out, where something from outside the catalogue explains more, where relatives of its own form do, and where too much
is left; then an unexplained remainder is what there is to say.
"""

from __future__ import annotations

import numpy as np

from bench.diagnose.candidates import EVENT, candidates, gains
from bench.diagnose.columns import lags, prepared
from bench.diagnose.fit import Fit, fit
from bench.diagnose.hypothesis import BACKLASH, DIRECTION, ECCENTRICITY, TRANSFORMS, Named
from bench.diagnose.outside import OUTSIDE, physics_of
from bench.diagnose.search import OFFSET, REMAINDER, SHARE, SIGNIFICANT, Step, refined, row_correlation
from bench.diagnose.shapes import free_shapes
from bench.diagnose.workbench import Workbench
from bench.effects.effect import Column, Signals

#: A large remainder, and the share of the first gap that names may leave in one; a dead zone's contact is never known.
LARGE, REMAINING, REMAINING_BACKLASH = 3.0, 0.2, 0.35
#: Share of its worth that a name keeps beside a rival from outside the catalogue that takes nothing of it.
KEPT = 0.5
#: How much further above its noise the holdout may stand than the recording, without the recording's events.
BORNE_OUT = 1.25
#: Share of a remainder that relatives of a name explain only if the name is of the wrong form, and residual over noise
#: that they then leave. Eccentricity under another name left 0.8 to 1.1; gravity of a pendulum on a gear 2.1.
FORM, FORMED = 0.5, 1.25
#: Effects whose torque is a wave of position.
WAVES = (
    "unbalance",
    "cogging_torque",
    "torque_ripple",
    "position_dependent_friction",
    "position_dependent_inertia",
    ECCENTRICITY,
)


def doubted(bench: Workbench, other: Workbench | None, steps: list[Step], excluded: frozenset[str]) -> list[Step]:
    """Steps of a search with what doubt leaves of the last one's names.

    Args:
        bench: the recording.
        other: the holdout.
        steps: of the search.
        excluded: effects that were not tried.
    """
    fitted = borne_out(bench, other, steps[-1].fitted)
    fitted = economical(bench, well_formed(bench, uncontested(bench, fitted, excluded)))
    final = believable(bench, steps[0].fitted, simpler(bench, fitted))
    if final.hypothesis.effects == steps[-1].fitted.hypothesis.effects:
        return steps
    return [*steps[:-1], Step(final, steps[-1].rivals)] if final.hypothesis.effects else steps[:1]


def borne_out(bench: Workbench, other: Workbench | None, fitted: Fit) -> Fit:
    """Without events whose absence the holdout does not explain: what they stood for happens there too.

    Unless it happens as an event there, at the same time of that recording.
    """
    events = [effect.shape for effect in fitted.hypothesis.effects if effect.name == EVENT]
    if other is None or not events:
        return fitted
    quiet = fitted.hypothesis
    while EVENT in quiet.names:
        quiet = quiet.without(quiet.names.index(EVENT))
    there = fit(other, quiet)
    least = BORNE_OUT * max(fitted.chi, 1.0)
    for event in events:
        if there.chi > least:
            there = _repeated(other, there, event)
    return fitted if there.chi < least else fit(bench, quiet)


def _repeated(other: Workbench, there: Fit, event: tuple[float, ...]) -> Fit:
    """The holdout's fit with the event it shows, if that overlaps the recording's by half."""
    shown = [found for found in candidates(other, there) if found.named.name == EVENT]
    if not shown:
        return there
    again = refined(other, there, shown[0])
    start, stop = again.hypothesis.effects[-1].shape
    shared = min(stop, event[1]) - max(start, event[0])
    return again if shared > 0.5 * min(stop - start, event[1] - event[0]) else there


def uncontested(bench: Workbench, fitted: Fit, excluded: frozenset[str]) -> Fit:
    """Without the names that something from outside the catalogue explains better, where a remainder is left.

    A rival that explains more, but of something else, contests nothing: beside it the name keeps its worth.
    """
    if fitted.chi < REMAINDER or not fitted.hypothesis.effects:
        return fitted
    for index in range(len(fitted.hypothesis.effects) - 1, -1, -1):
        less = fit(bench, fitted.hypothesis.without(index))
        rivals = [candidate for candidate in candidates(bench, less, excluded) if candidate.named.name in OUTSIDE]
        if not rivals:
            continue
        rival = refined(bench, less, rivals[0])
        beside = fit(bench, rival.hypothesis.with_effect(fitted.hypothesis.effects[index]))
        if outdone(bench, fitted, rival) and worth(rival, beside) < KEPT * worth(less, fitted):
            fitted = less
    return fitted


def outdone(bench: Workbench, fitted: Fit, rival: Fit) -> bool:
    """Whether a rival with a quantity or two more explains clearly more."""
    added = max(_freedom(bench, rival) - _freedom(bench, fitted), 1)
    least = max(SHARE * fitted.excess, SIGNIFICANT * added * row_correlation(bench) * fitted.floor**2)
    return worth(fitted, rival) > least


def _freedom(bench: Workbench, fitted: Fit) -> int:
    return fitted.theta.size + sum(len(free_shapes(effect, bench)) for effect in fitted.hypothesis.effects)


def worth(without: Fit, having: Fit) -> float:
    """Squares that an effect saves, summed over rows - (N*m)**2 (N**2)."""
    return float(np.sum(without.residual**2) - np.sum(having.residual**2))


def well_formed(bench: Workbench, fitted: Fit) -> Fit:
    """Without the names whose relatives explain most of the remainder: right where it sits, wrong what it is.

    What the unknown contact of a dead zone leaves speaks against no name.
    """
    if BACKLASH in fitted.hypothesis.names:
        return fitted
    index = len(fitted.hypothesis.effects) - 1
    while index >= 0 and fitted.chi > REMAINDER:
        saved, count = _by_relatives(bench, fitted, index)
        certain = SIGNIFICANT * count * row_correlation(bench) * fitted.floor**2
        left = (fitted.chi * fitted.floor) ** 2 - saved / fitted.residual.size
        if saved > max(FORM * fitted.excess, certain) and left < (FORMED * fitted.floor) ** 2:
            fitted = fit(bench, fitted.hypothesis.without(index))
            index = len(fitted.hypothesis.effects)
        index -= 1
    return fitted


def economical(bench: Workbench, fitted: Fit) -> Fit:
    """Without two waves of one period where a single wave of another form, in their place, leaves only noise."""
    waves = [index for index, name in enumerate(fitted.hypothesis.names) if name in WAVES]
    for late, early in ((late, early) for late in reversed(waves) for early in waves if early < late):
        effects = fitted.hypothesis.effects
        number = _wave_number(effects[late])
        if number != _wave_number(effects[early]):
            continue
        less = fit(bench, fitted.hypothesis.without(late).without(early))
        seen, (_, resting) = prepared(bench, less.hypothesis), lags(bench, less.hypothesis)
        columns = seen.table(lambda s, n=number: _waves(s, n), resting)
        half = columns.shape[1] // 2
        pairs = columns[:, np.stack([np.arange(half), half + np.arange(half)], axis=1).ravel()] * less.told[:, None]
        left = float(np.sum(less.residual**2) - gains(pairs, 2, less.residual, less.span).max())
        if left < np.count_nonzero(less.told) * (REMAINDER * fitted.floor) ** 2:
            return economical(bench, less)
    return fitted


def _by_relatives(bench: Workbench, fitted: Fit, index: int) -> tuple[float, int]:
    """Squares that relatives of an effect take from the residual - (N*m)**2 (N**2) -, and how many they are."""
    effect = fitted.hypothesis.effects[index]
    if effect.name not in WAVES:
        return 0.0, 1
    seen, (_, resting) = prepared(bench, fitted.hypothesis), lags(bench, fitted.hypothesis)
    columns = seen.table(lambda s: _waves(s, _wave_number(effect)), resting)
    return float(
        gains(columns * fitted.told[:, None], columns.shape[1], fitted.residual, fitted.span)[0]
    ), columns.shape[1]


def _wave_number(effect: Named) -> float:
    if effect.name in TRANSFORMS or not physics_of(effect.name).shapes:
        return 1.0
    return effect.shape[0]


def _waves(s: Signals, number: float) -> list[Column]:
    """Waves of position times whatever a torque may hang on: nothing, omega**2, its direction, torque, acceleration."""
    columns: list[Column] = []
    for wave in (np.sin(number * s.position), np.cos(number * s.position)):
        columns += [[(factor * wave, 0)] for factor in (np.ones_like(wave), s.velocity**2, s.sign, s.torque)]
        columns.append([(s.velocity * wave, 1)])
    return columns


def believable(bench: Workbench, before: Fit, fitted: Fit) -> Fit:
    """No names, or none of an event, where so much is left that they are likelier the nearest than the right ones."""
    if fitted.chi < LARGE:
        return fitted
    bearable = REMAINING_BACKLASH if BACKLASH in fitted.hypothesis.names else REMAINING
    if fitted.excess > bearable * before.excess:
        return before
    events = [index for index, name in enumerate(fitted.hypothesis.names) if name == EVENT]
    return fit(bench, fitted.hypothesis.without(events[0])) if events else fitted


def simpler(bench: Workbench, fitted: Fit) -> Fit:
    """A torque offset instead of direction-dependent friction where viscous friction does not differ."""
    names = fitted.hypothesis.names
    if DIRECTION not in names:
        return fitted
    plain = fit(bench, fitted.hypothesis.without(names.index(DIRECTION)).with_effect(Named(OFFSET)))
    lost = float(np.sum(plain.residual**2) - np.sum(fitted.residual**2))
    return plain if lost < SIGNIFICANT * row_correlation(bench) * fitted.floor**2 else fitted
