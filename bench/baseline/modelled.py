"""A model of an axis as a state, and the comparison of two of them.

All values are exact, so nothing is undecided: a quantity has changed if it differs by more than its margin, an effect
is present or absent. Values show a change of the file, the response one of the simulator.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from bench.arrays import rms
from bench.baseline.allowed import Allowed
from bench.baseline.compare import Checked
from bench.baseline.comparison import CHANGED, RESULTS, SAME, Comparison
from bench.baseline.names import matched
from bench.baseline.response import RESPONSE_TORQUE, response
from bench.baseline.state import NamedHere, State
from bench.comparison.difference import Difference, Measured
from bench.plant.model import parameter_quantities
from bench.plant.model_file import SCHEMA, StoredModel, load_model, read_table
from bench.units import Quantity

#: Margins: of an angle - rad -, and of the torque of the response as a share of its RMS.
ANGLE, RESPONSE = 0.05, 0.01


def is_model(path: str | Path) -> bool:
    """Whether a file is a `model.toml`, a baseline of a model too."""
    return Path(path).exists() and read_table(path).get("schema") == SCHEMA


def modelled(path: str | Path, baseline: State | None = None) -> State:
    """The state of a `model.toml` that `bench diagnose` wrote.

    Args:
        path: of the model.
        baseline: whose run the response repeats; without one, a run laid out for the model.

    Raises:
        InputError: no such model.
        SimulationError: the model diverged.
    """
    stored = load_model(path)
    own, kind = stored.model.parameters, stored.model.parameters.kind
    quantities = {q.name: Measured(getattr(own, f), q.unit, 0.0) for f, q in parameter_quantities(kind).items()}
    run = response(stored.model, None if baseline is None else baseline.response)
    return State("model", True, quantities, tuple(_effects(stored)), rig={"kind": kind.name}, response=run)


def _effects(stored: StoredModel) -> Iterator[NamedHere]:
    kind = stored.model.parameters.kind
    for present in stored.model.effects:
        values, known = dict(present.values), {q.name: q for q in present.effect.quantities}
        found = {key: Measured(value, kind.unit(known[key]), 0.0) for key, value in values.items()}
        shape = [values.get(slot.quantity.name, math.nan) for slot in present.effect.shapes]
        yield NamedHere(present.effect, found, tuple(shape))


def compare_models(baseline: State, now: State, allowed: Allowed) -> Checked:
    """Whether a model is the same: its values, its effects, and how it moves.

    Args:
        baseline: what it was.
        now: what it is.
        allowed: margins.
    """
    found = matched(baseline, now)
    comparisons = [
        _of_value(name, *pair, allowed, baseline) for name, pair in _pairs(baseline.quantities, now.quantities)
    ]
    for before, after in (*found.both, *found.renamed):
        for key, pair in _pairs(before.quantities, after.quantities):
            quantity = next(q for q in before.effect.quantities if q.name == key)
            comparisons.append(_of_value(f"{before.label}.{key}", *pair, allowed, baseline, quantity))
    comparisons += [_of_presence(effect, "gone") for effect in found.gone]
    comparisons += [_of_presence(effect, "appeared") for effect in found.appeared]
    comparisons += _of_response(baseline, now)
    comparisons.sort(key=lambda one: RESULTS.index(one.result))
    by_name = {one.name: one for one in comparisons}
    return Checked(
        result=CHANGED if any(one.result == CHANGED for one in comparisons) else SAME,
        comparisons=tuple(comparisons),
        baseline=baseline,
        now=now,
        appeared=tuple((effect, by_name[effect.label]) for effect in found.appeared),
        gone=tuple((effect, by_name[effect.label]) for effect in found.gone),
        rig=(),
        conditions=(),
        false_alarm_rate=0.0,
        family=len(comparisons),
    )


def _pairs(
    before: Mapping[str, Measured], after: Mapping[str, Measured]
) -> list[tuple[str, tuple[Measured, Measured]]]:
    return [(name, (before[name], after[name])) for name in before if name in after]


def _of_value(
    name: str, before: Measured, after: Measured, allowed: Allowed, state: State, quantity: Quantity | None = None
) -> Comparison:
    """Comparison of an exact value; angles by the shorter way round."""
    away, margin = after.value - before.value, allowed.margin_of(name, before, state)
    if quantity is not None and quantity.angle:
        away, margin = math.remainder(away, 2.0 * math.pi), ANGLE
    if not math.isfinite(away):
        away = 0.0 if after.value == before.value else math.inf
    return _exact(name, before.unit, (before.value, after.value), away, margin)


def _of_presence(effect: NamedHere, how: str) -> Comparison:
    return Comparison(effect.label, "", None, None, (), 0.0, how, chance=0.0, result=CHANGED)


def _of_response(baseline: State, now: State) -> list[Comparison]:
    """Comparison of the torque of both runs."""
    if baseline.response is None or now.response is None:
        return []
    before, after = np.array(baseline.response.torque), np.array(now.response.torque)
    return [
        _exact(
            RESPONSE_TORQUE,
            now.kind.effort_unit,
            (rms(before), rms(after)),
            rms(after - before),
            RESPONSE * rms(before),
        )
    ]


def _exact(name: str, unit: str, values: tuple[float, float], away: float, margin: float) -> Comparison:
    same = away == 0.0 or abs(away) <= margin < math.inf  # a share of an infinite value is no margin
    difference = Difference(away, 0.0, math.inf)
    return Comparison(name, unit, *values, (difference,), margin, chance=float(same), result=SAME if same else CHANGED)
