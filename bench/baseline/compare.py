"""Compare two states of an axis: quantities, names, gaps and verdict, at one false-alarm rate for all of them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.baseline.allowed import FLOOR, MARGINS, OTHER_MOTION, Allowed
from bench.baseline.comparison import CHANGED, RESULTS, SAME, UNDECIDED, Comparison
from bench.baseline.conditions import unlike
from bench.baseline.names import matched, of_both, of_names
from bench.baseline.observe import Observed, Under
from bench.baseline.same_rig import differing
from bench.baseline.state import GAPS, TORQUE_GAP, VELOCITY_GAP, NamedHere, State
from bench.comparison.difference import Difference, Measured, holm
from bench.effects.catalogue import catalogue


@dataclass(frozen=True)
class Checked:
    """What a check found.

    Attributes:
        result: `same`, `changed` or `undecided`.
        comparisons: of every quantity and name, worst first.
        baseline, now: the states.
        appeared, gone: effects that are named in one of the states only, with their comparisons.
        rig, conditions: a line for each difference in the rig, and in motion and sampling.
        false_alarm_rate: of all comparisons together.
        family: number of comparisons, including those of effects that neither state names.
    """

    result: str
    comparisons: tuple[Comparison, ...]
    baseline: State
    now: State
    appeared: tuple[tuple[NamedHere, Comparison], ...]
    gone: tuple[tuple[NamedHere, Comparison], ...]
    rig: tuple[str, ...]
    conditions: tuple[str, ...]
    false_alarm_rate: float
    family: int


def compare(baseline: State, now: Observed, allowed: Allowed, rate: float) -> Checked:
    """Whether the axis is the same.

    Args:
        baseline: what it was.
        now: what it is by recordings, or by a model.
        allowed: margins and spreads.
        rate: probability that an axis that differs by no more than its margins is called changed.
    """
    state = now.state
    rig, moved = differing(baseline.rig, state.rig), unlike(baseline.conditions, state.conditions)
    found = matched(baseline, state)
    under = None if found.alike or now.fitted is None else now.under(found.others(baseline))
    other_motion = "the motion is not that of the baseline" if moved else ""
    names = [*of_names(found, {} if under is None else under.torques, baseline, allowed, other_motion)]
    pairs = [*of_both(found.both, allowed, baseline, OTHER_MOTION if moved else 0.0)]
    silent = _silent(baseline, state) if baseline.shows is not None else 0
    family = len(baseline.quantities) + len(names) + len(pairs) + silent
    sure = all(one.chance <= rate / family for one in names)
    views = [*_views(state, under, sure)]
    quantities = [*_of_quantities(baseline, views, allowed, bool(moved)), *_missing_now(baseline, state)]
    comparisons = [*quantities, *pairs, *names]
    if rig:
        comparisons = [replace(one, chance=1.0, held_back="the rig is not that of the baseline") for one in comparisons]
    chances = holm(np.array([one.chance for one in comparisons]), silent)
    answered = [one.answered(bool(chance <= rate)) for one, chance in zip(comparisons, chances, strict=True)]
    answered.sort(key=lambda one: (RESULTS.index(one.result), one.chance))
    by_name = {one.name: one for one in answered}
    return Checked(
        result=_overall(answered, baseline, state),
        comparisons=tuple(answered),
        baseline=baseline,
        now=state,
        appeared=tuple((effect, by_name[effect.label]) for effect in found.appeared),
        gone=tuple((effect, by_name[effect.label]) for effect in found.gone),
        rig=tuple(rig),
        conditions=tuple(moved),
        false_alarm_rate=rate,
        family=family,
    )


@dataclass(frozen=True)
class View:
    """A quantity now, fitted with the effects of this state, of the baseline, or of each in turn.

    Attributes:
        name: of the quantity.
        values: one, or one for each set of effects.
        noise_floor: of a torque gap - N*m (N).
    """

    name: str
    values: tuple[Measured, ...]
    noise_floor: float = float("nan")


def _views(now: State, under: Under | None, sure: bool) -> Iterator[View]:
    """Quantities now.

    Args:
        now: the state.
        under: with the effects of the baseline; None where they are the same.
        sure: whether all names that differ are significant. Then the axis changed, and each state is described by its
            own effects; where a name is near its threshold, a change has to show with both sets.
    """
    for name, own in now.quantities.items():
        if name == TORQUE_GAP:  # what the effects of the baseline leave now, whatever else was found
            floor = now.gaps["torque"].noise_floor if under is None else under.noise_floor
            yield View(name, (own if under is None else under.quantities[name],), floor)
        elif name == VELOCITY_GAP and under is not None:
            continue  # models with other effects are compared by these
        elif under is None or sure or name not in under.quantities:
            yield View(name, (own,))
        else:
            yield View(name, (own, under.quantities[name]))


def _of_quantities(baseline: State, views: Sequence[View], allowed: Allowed, moved: bool) -> Iterator[Comparison]:
    """Comparisons of parameters and gaps; `moved`: whether motion or sampling differ."""
    for view in (view for view in views if view.name in baseline.quantities):
        name, before, now = view.name, baseline.quantities[view.name], view.values[0]
        values = before.value, now.value
        if before.unit != now.unit:
            yield Comparison.of(name, before.unit, (before.value, None), [], 0.0, held_back=f"now in {now.unit}")
            continue
        held_back = "what a model leaves depends on the motion" if name in GAPS and moved else ""
        between = allowed.between_of(name, before)
        beside = OTHER_MOTION * between if moved else 0.0
        differences = [Difference.of(before, value, between, beside) for value in view.values]
        margin = allowed.margin_of(name, before, baseline)
        least = 0.0 if name != TORQUE_GAP else _louder(baseline, view)
        yield Comparison.of(name, before.unit, values, differences, margin, held_back=held_back, least_chance=least)


def _missing_now(baseline: State, now: State) -> Iterator[Comparison]:
    """Quantities of the baseline that the recordings now do not determine."""
    for name, before in baseline.quantities.items():
        if name not in now.quantities:
            yield Comparison.of(name, before.unit, (before.value, None), [], 0.0, held_back="it is not told now")


def _louder(baseline: State, view: View) -> float:
    """Probability of this difference of the torque gap over its noise floor, if only the sensors' noise had grown."""
    before = baseline.gaps["torque"]
    ratio, now = before.after / before.noise_floor, view.values[0].value / view.noise_floor
    shown = Difference(now - ratio, math.sqrt(2.0) * FLOOR * ratio, math.inf)
    return shown.chance(MARGINS[TORQUE_GAP] * ratio)


def _silent(baseline: State, now: State) -> int:
    """Number of effects that neither state names: they were searched for too."""
    return len(set(catalogue()) - {effect.name for effect in (*baseline.effects, *now.effects)})


def _overall(answered: list[Comparison], baseline: State, now: State) -> str:
    """The overall result. A verdict that differs alone is near its threshold and decides nothing."""
    results = {one.result for one in answered}
    if CHANGED in results:
        return CHANGED
    return SAME if results <= {SAME} and baseline.verdict == now.verdict else UNDECIDED
