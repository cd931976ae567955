"""Check an axis against its baseline: quantities, names, gaps and verdict, at one false-alarm rate for all of them.

Naming is a threshold: an effect near it is named in one recording and not in the next. So torques are compared instead
of names. For an effect that the baseline does not name there is an upper bound - the torque from which on it would have
been named, or that the residual may hide -; it has appeared if its torque is clearly above that now. An effect that the
baseline names is fitted again, named or not.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from bench.axis_kind import COULOMB, INERTIA, ROTARY, VISCOUS, AxisKind
from bench.baseline.observe import Observed, differing, motion_ratio, observe, unlike
from bench.baseline.state import TORQUE_GAP, VELOCITY_GAP, AxisEffect, State, read_baseline
from bench.comparison.difference import CHANGED, RESULTS, SAME, UNDECIDED, Comparison, Difference, Measured, holm
from bench.effects.catalogue import catalogue
from bench.effects.effect import Occasional
from bench.errors import InputError
from bench.names import nearest, with_known_arguments
from bench.presented import Presented
from bench.rig.given import Given, GivenRig, Units, recordings_of
from bench.rig.rig import CheckTable, Rig
from bench.units import parse

#: Probability of a false alarm of an unchanged axis, over all comparisons together.
FALSE_ALARM_RATE = 0.01
_SHARE = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*%\s*")
#: Default margins, as shares of the baseline's value.
MARGINS = {INERTIA: 0.005, VISCOUS: 0.15, COULOMB: 0.03, TORQUE_GAP: 0.25, VELOCITY_GAP: 0.5}
#: Default standard deviations between recordings, as shares of the baseline's value, of a warm axis that moves alike.
BETWEEN = {INERTIA: 0.001, VISCOUS: 0.03, COULOMB: 0.0075, TORQUE_GAP: 0.04, VELOCITY_GAP: 0.1}
#: Relative standard deviation of a recording's noise floor: coloured noise is hard to separate from a gap.
FLOOR = 0.12
#: Default margin, and standard deviation between recordings, of quantities of effects and of their torque.
OF_EFFECTS, BETWEEN_OF_EFFECTS = 0.25, 0.05
#: Share of the effort of a motion below which the contribution of a parameter does not matter.
LEAST = 1e-3
#: Factor on these for other motion or sampling: of two recordings at 95 % what `bench.diagnosis.same_axis` allows.
OTHER_MOTION = 5.0
#: Power of the largest factor between motions that residuals go with (drag 2, saturation 3), and the largest allowed.
POWER, COMPARABLE = 3.0, 1.45
#: The quantity of a motion that a parameter's torque is proportional to.
_MADE_OF = {INERTIA: "rms_acceleration", VISCOUS: "rms_speed"}


@with_known_arguments
def check(
    trace: Given | Sequence[Given],
    rig: GivenRig | None,
    baseline: State | str | Path,
    false_alarm_rate: float = FALSE_ALARM_RATE,
    progress: Callable[[float], None] = lambda share: None,
    units: Units | None = None,
) -> Checked:
    """Whether an axis still is as its baseline; effects are searched for if the baseline names them.

    Args:
        trace: a recording of the axis now, or its file, arrays or a data frame; or a list of several.
        rig: of the axis, as `identify` takes it.
        baseline: its earlier state, or the file that `bench check --update` wrote.
        false_alarm_rate: probability that an axis within its margins is called changed, over all comparisons.
        progress: called with the share done.
        units: of columns by their names, which replace those of the file or data frame.

    Raises:
        UndeterminedError: the recording does not determine what the baseline contains.
        InputError: rig and recording do not fit together, or the baseline is that of a model.
    """
    rig, traces = recordings_of(trace, rig, units)
    baseline = baseline if isinstance(baseline, State) else read_baseline(Path(baseline))
    baseline.require_source("recordings")
    return compare(baseline, observe(traces, rig, baseline.names, progress), Allowed.of(rig), false_alarm_rate)


@dataclass(frozen=True, repr=False)
class Checked(Presented):
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
    appeared: tuple[tuple[AxisEffect, Comparison], ...]
    gone: tuple[tuple[AxisEffect, Comparison], ...]
    rig: tuple[str, ...] = ()
    conditions: tuple[str, ...] = ()
    false_alarm_rate: float = 0.0
    family: int = 0

    @classmethod
    def of(cls, answered: Sequence[Comparison], baseline: State, now: State, effects: Matched) -> Checked:
        """From answered comparisons; a verdict that differs alone is near its threshold and decides nothing."""
        worst_first = sorted(answered, key=lambda one: (RESULTS.index(one.result), one.chance))
        by_name, results = {one.name: one for one in worst_first}, {one.result for one in answered}
        same = results <= {SAME} and baseline.verdict == now.verdict
        return cls(
            result=CHANGED if CHANGED in results else SAME if same else UNDECIDED,
            comparisons=tuple(worst_first),
            baseline=baseline,
            now=now,
            appeared=tuple((effect, by_name[effect.label]) for effect in effects.appeared),
            gone=tuple((effect, by_name[effect.label]) for effect in effects.gone),
            family=len(answered),
        )


def compare(baseline: State, now: Observed, allowed: Allowed, rate: float) -> Checked:
    """Whether the axis is what it was, by recordings, at a rate of false alarms as `check` has it."""
    state = now.state
    rig, moved = differing(baseline.rig, state.rig), unlike(baseline.conditions, state.conditions)
    ratio = motion_ratio(baseline.conditions, state.conditions) if moved else 1.0
    allowed = replace(allowed, motion=ratio)
    effects = matched(baseline, state)
    under = None if effects.alike or now.fitted is None else now.under(effects.others(baseline))
    names = [*_of_names(effects, under, baseline, allowed)]
    pairs = [*_of_both(effects.both, allowed, baseline)]
    named = {effect.name for effect in (*baseline.effects, *state.effects)}  # the others were searched for too
    silent = len(set(catalogue()) - named) if baseline.shows is not None else 0
    family = len(baseline.quantities) + len(names) + len(pairs) + silent
    # Where all names that differ are significant the axis changed, and each state is described by its own effects;
    # where a name is near its threshold, a change has to show with the effects of both.
    both_sets = None if all(one.chance <= rate / family for one in names) else under
    quantities = [*_of_quantities(baseline, state, under, both_sets, allowed)]
    missing = [name for name in baseline.quantities if name not in state.quantities]
    quantities += [_undetermined(name, "it is not determined now", baseline.quantities[name]) for name in missing]
    comparisons = [*quantities, *pairs, *names]
    if rig:
        comparisons = [replace(one, chance=1.0, held_back="the rig is not that of the baseline") for one in comparisons]
    chances = holm(np.array([one.chance for one in comparisons]), silent)
    answered = [one.answered(bool(chance <= rate)) for one, chance in zip(comparisons, chances, strict=True)]
    found = Checked.of(answered, baseline, state, effects)
    return replace(found, rig=tuple(rig), conditions=tuple(moved), false_alarm_rate=rate, family=family)


def _of_quantities(
    baseline: State, now: State, under: State | None, both_sets: State | None, allowed: Allowed
) -> Iterator[Comparison]:
    """Comparisons of parameters and gaps.

    `under` is now with the effects of the baseline, None where they are the same; `both_sets` is that where a change
    has to show with both sets of effects.
    """
    for name, own in now.quantities.items():
        if name not in baseline.quantities or (name == VELOCITY_GAP and under is not None):
            continue  # simulated models with other effects are compared by these
        before, values, least_chance = baseline.quantities[name], [own], 0.0
        between, margin = allowed.between_of(name, before), allowed.margin_of(name, before, baseline)
        if before.unit != own.unit:
            yield _undetermined(name, f"now in {own.unit}", before)
            continue
        if name == TORQUE_GAP:  # what the effects of the baseline leave now, whatever else was found
            if under is not None:
                values = [under.quantities[name]]
            floor = (under or now).gaps["torque"].noise_floor.value
            least_chance, margin = _louder(baseline, values[0].value / floor), allowed.moved(margin, before.value)
        elif both_sets is not None and name in both_sets.quantities:
            values.append(both_sets.quantities[name])
        differences = tuple(Difference.of(before, value, between, allowed.otherwise * between) for value in values)
        held_back = allowed.unlike if name == TORQUE_GAP else ""
        if name == VELOCITY_GAP and allowed.otherwise:
            held_back = "the residual of a simulation depends on the motion"
        found = Comparison(name, before.unit, before.value, values[0].value, differences, margin, held_back=held_back)
        yield found.tested(least_chance)


def _undetermined(name: str, why: str, before: Measured | None = None, effect: str = "") -> Comparison:
    """A quantity, or the torque of an effect, that has no value now to be held against the baseline's."""
    unit, value = ("", None) if before is None else (before.unit, before.value)
    return Comparison(name, unit, value, None, (), 0.0, effect, why)


def _louder(baseline: State, now: float) -> float:
    """Probability of this torque gap over its noise floor, if only the sensors' noise had grown since the baseline."""
    before = baseline.gaps["torque"]
    ratio = before.after.value / before.noise_floor.value
    shown = Difference(now - ratio, math.sqrt(2.0) * FLOOR * ratio)
    return shown.chance(MARGINS[TORQUE_GAP] * ratio)


@dataclass(frozen=True)
class Matched:
    """Effects of two states, matched; those that occur in every recording of the axis.

    Attributes:
        both: pairs of one name.
        renamed: pairs that a recording cannot distinguish.
        gone, appeared: those that only the baseline, only the state now has.
    """

    both: tuple[tuple[AxisEffect, AxisEffect], ...]
    renamed: tuple[tuple[AxisEffect, AxisEffect], ...]
    gone: tuple[AxisEffect, ...]
    appeared: tuple[AxisEffect, ...]

    @property
    def alike(self) -> bool:
        """Whether both states have the same effects."""
        return not (self.renamed or self.gone or self.appeared)

    def others(self, baseline: State) -> list[tuple[AxisEffect, AxisEffect | None]]:
        """Effects of the baseline, each with its match now; None without one."""
        own = {before.label: now for before, now in self.both}
        return [(effect, own.get(effect.label)) for effect in _lasting(baseline)]


def _lasting(state: State) -> list[AxisEffect]:
    return [effect for effect in state.effects if not isinstance(effect.effect, Occasional)]


def matched(baseline: State, now: State) -> Matched:
    """Pairs of the same effect, then pairs that are `ambiguous_with` each other, then the rest."""
    before, after = _lasting(baseline), _lasting(now)
    both, renamed = list[tuple[AxisEffect, AxisEffect]](), list[tuple[AxisEffect, AxisEffect]]()
    for pairs, alike in ((both, AxisEffect.same), (renamed, AxisEffect.indistinguishable_from)):
        for one in list(before):
            other = next((candidate for candidate in after if alike(one, candidate)), None)
            if other is not None:
                before.remove(one)
                after.remove(other)
                pairs.append((one, other))
    return Matched(tuple(both), tuple(renamed), tuple(before), tuple(after))


def _of_both(pairs: Sequence[tuple[AxisEffect, AxisEffect]], allowed: Allowed, state: State) -> Iterator[Comparison]:
    """Comparisons of the quantities of effects that both states name."""
    for before, after in pairs:
        for key in (key for key in before.compared if key in after.compared):
            key_in_full, baseline, now = f"{before.name}.{key}", before.compared[key], after.compared[key]
            between = allowed.between_of(key_in_full, baseline)
            difference = Difference.of(baseline, now, between, allowed.otherwise * between)
            margin = allowed.margin_of(key_in_full, baseline, state)
            name = key_in_full if before.name == before.label else f"{before.label}: {key}"
            yield Comparison(name, baseline.unit, baseline.value, now.value, (difference,), margin).tested()


def _of_names(found: Matched, under: State | None, baseline: State, allowed: Allowed) -> Iterator[Comparison]:
    """Comparisons of all names that differ."""
    torques = {} if under is None else {one.label: one.torque for one in under.effects}
    for before, after in found.renamed:
        yield _of_torque(before, after.torque, allowed, f"{before.label} or {after.label}")
    for before in found.gone:
        yield _of_torque(before, torques.get(before.label), allowed, before.label, "gone")
    for after in found.appeared:
        yield _of_appeared(after, baseline, allowed)


def _of_torque(before: AxisEffect, now: Measured | None, allowed: Allowed, name: str, effect: str = "") -> Comparison:
    """Comparison of the torque of an effect of the baseline, whatever its name is now."""
    was = before.torque
    if was is None or now is None:
        return _undetermined(name, "the torque balance does not hold it, so its strength is not known", effect=effect)
    difference = Difference.of(was, now, allowed.between_of(before.name, was))
    margin = allowed.moved(OF_EFFECTS * was.value, was.value)
    return Comparison(name, was.unit, was.value, now.value, (difference,), margin, effect, allowed.unlike).tested()


def _of_appeared(after: AxisEffect, baseline: State, allowed: Allowed) -> Comparison:
    """Comparison of the torque of an effect that is new with what the baseline's recording would have shown."""
    torque = after.torque
    if torque is None or baseline.shows is None:
        why = "found in its signals only; they do not show from which size on the baseline would have found it"
        return _undetermined(after.label, why, effect="appeared")
    significant = baseline.shows.torque.value * math.sqrt(max(len(after.quantities), 1))
    least = allowed.factor * max(significant, baseline.shows.residual.value)
    nothing = Measured(0.0, torque.unit, torque.std_error)
    difference = Difference.of(nothing, torque, allowed.between_of(after.name, torque))
    found = Comparison(after.label, torque.unit, None, torque.value, (difference,), least, "appeared", allowed.unlike)
    return found.tested()


@dataclass(frozen=True)
class Allowed:
    """Margins below which no change matters, and spreads between recordings of one axis, by quantity, as its rig has
    them.

    A quantity is `coulomb_friction_torque`, `cogging_torque.amplitude`, `torque_gap`; its value a share of the
    baseline's, "2 %", or a number with its unit. `source` is where they are stated, for messages. `motion` is the
    largest factor by which motion and sampling differ from the baseline's, 1 where they do not.
    """

    kind: AxisKind
    margin: Mapping[str, str] = field(default_factory=dict)
    between: Mapping[str, str] = field(default_factory=dict)
    source: str = "rig"
    motion: float = 1.0

    @property
    def factor(self) -> float:
        """Largest change of a residual, or of the torque of an effect, that another motion causes."""
        return self.motion**POWER

    @property
    def unlike(self) -> str:
        """Why these cannot be compared; empty if they can."""
        return "the motion is not that of the baseline" if self.motion > COMPARABLE else ""

    @property
    def otherwise(self) -> float:
        """Standard deviations between recordings by which another motion may change quantities."""
        return OTHER_MOTION if self.motion > 1.0 else 0.0

    def moved(self, margin: float, before: float) -> float:
        """A margin that contains what the motion may do to a value and its margin."""
        return self.factor * (before + margin) - before

    @classmethod
    def of(cls, rig: Rig | None, kind: AxisKind = ROTARY) -> Allowed:
        """Those of a rig, or the defaults of a kind of axis without one; InputError where a quantity is not known."""
        if rig is None:
            return cls(kind)
        stated, source = rig.check or CheckTable(), f"{rig.source}: check"
        own = [*rig.axis_kind.base_parameters(), TORQUE_GAP, VELOCITY_GAP]
        known = f"{', '.join(own)}, or EFFECT.QUANTITY as in bench list effects"
        for table, names in (("margin", stated.margin), ("between", stated.between)):
            for name in (name for name in names if name not in own):
                of_effects = [f"{effect.name}.{q.name}" for effect in catalogue().values() for q in effect.quantities]
                if name not in of_effects:
                    found = f"found '{name}'{nearest(name, [*own, *of_effects])}"
                    raise InputError(f"{source}.{table}", found, f"allowed: {known}")
        return cls(rig.axis_kind, stated.margin, stated.between, source)

    def margin_of(self, name: str, baseline: Measured, state: State) -> float:
        """Change of a quantity below which it does not matter - its unit.

        The motion of the baseline, `state`, gives the torque of a parameter, of which some never matters.
        """
        if name in self.margin:
            return _stated(self.margin[name], baseline, f"{self.source}.margin.{name}")
        term = self._term(name)
        share = MARGINS.get(term or name, OF_EFFECTS) * abs(baseline.value)
        effort = state.conditions.get("rms_effort")
        if term is None or effort is None:
            return share
        made_of = state.conditions[_MADE_OF[term]].value if term in _MADE_OF else 1.0
        return max(share, LEAST * effort.value / max(made_of, 1e-300))

    def between_of(self, name: str, baseline: Measured) -> float:
        """Standard deviation of a quantity between recordings - its unit."""
        if name in self.between:
            return _stated(self.between[name], baseline, f"{self.source}.between.{name}")
        return BETWEEN.get(self._term(name) or name, BETWEEN_OF_EFFECTS) * abs(baseline.value)

    def _term(self, name: str) -> str | None:
        return next((term for term in (INERTIA, VISCOUS, COULOMB) if self.kind.parameter(term) == name), None)


def _stated(text: str, baseline: Measured, where: str) -> float:
    """A share of the baseline's value, or a number with its unit, in the quantity's unit."""
    match = _SHARE.fullmatch(text)
    value = 0.01 * float(match[1]) * abs(baseline.value) if match else parse(text, baseline.unit, where)
    if value < 0.0:
        raise InputError(where, f"found {text!r}", 'allowed: zero or above, e.g. "2 %"')
    return value
