"""The list of mutants, generated from the objects themselves: rules, doubts and judges, then every effect."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from bench.diagnosis.show.verdict import OBJECTIONS
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect
from bench.effects.kinds import Electronics, Friction, Mechanism, Sensing
from bench.effects.signals import Signals
from bench.fit.stored import Balance
from tests.diagnosis.off import OFF

#: Environment variable that names the mutant to be made.
MUTANT = "SERVOBENCH_MUTANT"
TESTS = Path(__file__).resolve().parents[2]
#: What an effect is when it overrides nothing.
NEUTRAL = (Effect, Mechanism, Friction, Electronics, Sensing)
#: Without a neutral value: what an effect is called, and what it has.
GIVEN = ("name", "summary", "quantities")
#: Tests of rules, doubts and judges.
DECISIONS = ("diagnose/test_policy.py", "diagnose/test_doubts.py", "diagnose/test_judges.py")
#: Tests that run over all effects, fast ones first; those of one are picked by its name.
OF_EVERY_EFFECT = (
    "effects/test_contract.py",
    "effects/test_properties.py",
    "effects/test_sensing.py",
    "effects/test_track_effects.py",
    "effects/test_agreement.py",
    "effects/test_diagnosed.py",
)
#: Tests that ask for nothing of an effect by name, and may still notice.
BEYOND = (
    "effects/test_properties.py",
    "effects/test_sensing.py",
    "diagnose/test_columns.py",
    "balance",
    *DECISIONS,
    "effects/test_linear_axis.py",
    "effects/test_model_file.py",
    "effects/test_follow.py",
    "diagnose/test_soft_coupling.py",
    "diagnose/test_hidden_effects.py",
)


@dataclass(frozen=True)
class Mutant:
    """One change that some test has to notice.

    Attributes:
        name: `rule Significant`, `cogging_torque: column 1 turned`.
        apply: makes the change, for as long as the process lives.
        stages: arguments of pytest, the run likeliest to notice first.
    """

    name: str
    apply: Callable[[], None]
    stages: tuple[tuple[str, ...], ...]


def mutants() -> dict[str, Mutant]:
    """All of them by name."""
    return {mutant.name: mutant for mutant in (*_decisions(), *_effects())}


def paths(*names: str) -> tuple[str, ...]:
    """Those of the files and folders of tests that there are."""
    return tuple(str(TESTS / name) for name in names if (TESTS / name).exists())


def _decisions() -> Iterator[Mutant]:
    stages = (paths(*DECISIONS),)
    for kind, (method, off) in OFF.items():
        what = "doubt" if kind.__module__.endswith("doubts") else "rule"
        yield Mutant(f"{what} {kind.__name__} off", partial(setattr, kind, method, off), stages)
    yield Mutant("rule most off", _without_limit, stages)
    for kind in map(type, OBJECTIONS):
        quiet = partial(setattr, kind, "against", lambda self, shown: "")
        yield Mutant(f"objection {kind.__name__} off", quiet, (paths("diagnose/test_verdict.py", *DECISIONS),))
    late = (paths(*reversed(DECISIONS)),)
    yield Mutant("judge torque gap off", _without_torque_gap, late)
    yield Mutant("judge velocity gap off", partial(_replace, ADD, "_comes_closer", lambda *_: True), late)
    yield Mutant("judge unlimited off", partial(_replace, ADD, "unlimited", lambda *_: None), late)


ADD, SEARCH = "bench.diagnosis.add.add", "bench.diagnosis.name.search"


def _replace(module: str, name: str, value: Any) -> None:
    setattr(importlib.import_module(module), name, value)


def _without_limit() -> None:
    selection = importlib.import_module(SEARCH).forward_selection

    def unlimited(found: Any, effects: Any, rules: Any) -> Any:
        return selection(found, effects, replace(rules, most=99))

    _replace(SEARCH, "forward_selection", unlimited)


def _without_torque_gap() -> None:
    """Within the judgement the torque gap is the same with and without an effect."""
    rejection, gap = importlib.import_module(ADD).rejection, Balance.gap

    def judged(trial: Any) -> Any:
        Balance.gap = lambda self, rows: 0.0
        found = rejection(trial)
        Balance.gap = gap
        return found

    _replace(ADD, "rejection", judged)


def _effects() -> Iterator[Mutant]:
    for name, effect in catalogue().items():
        stages = ((*paths(f"effects/test_{name}.py", *OF_EVERY_EFFECT), "-k", name), paths(*BEYOND))
        for what, apply in _changes(type(effect)):
            yield Mutant(f"{name}: {what}", apply, stages)


def _changes(kind: type[Effect]) -> Iterator[tuple[str, Callable[[], None]]]:
    own = [base for base in kind.__mro__ if issubclass(base, Effect) and base not in NEUTRAL]
    for column in range(_width(kind)):
        yield f"column {column} turned", partial(_change_columns, kind, column, True)
        yield f"column {column} dropped", partial(_change_columns, kind, column, False)
    for key in inspect.get_annotations(Effect):
        if key not in GIVEN and getattr(kind, key) != getattr(Effect, key):
            yield f"{key} unset", partial(setattr, kind, key, getattr(Effect, key))
    for base in own:
        for key, value in vars(base).items():
            if inspect.isfunction(value) and any(key in vars(neutral) for neutral in NEUTRAL):
                yield f"{key} neutral", partial(_neutral, base, key)


def _neutral(kind: type[Effect], key: str) -> None:
    """Take an override away; an effect that is absent nowhere has no null values."""
    if key == "null":
        kind.null = lambda self, axis: {}
    else:
        delattr(kind, key)


def _width(kind: type[Effect]) -> int:
    """Columns of an effect, of a short swing."""
    if not kind.overrides("columns"):
        return 0
    time = 1e-3 * np.arange(200)
    angle, speed = np.sin(20.0 * time), 20.0 * np.cos(20.0 * time)
    sign = np.sign(speed)
    signals = Signals(time, angle, speed, sign, sign, sign, sign, 1.0, 1e-3)
    effect = catalogue()[kind.name]
    return len(effect.columns(signals, [shape.grid[0] if shape.grid else 0.01 for shape in effect.shapes]))


def _change_columns(kind: type[Effect], column: int, turned: bool) -> None:
    """Turn the sign of a column, or drop it."""
    width, columns, columns_of = _width(kind), kind.columns, kind.columns_of

    def changed(found: list) -> list:
        if turned:
            return [[(-v, order) for v, order in each] if k % width == column else each for k, each in enumerate(found)]
        return [each for k, each in enumerate(found) if k % width != column]

    kind.columns = lambda self, *given: changed(columns(self, *given))
    if kind.overrides("columns_of"):
        kind.columns_of = lambda self, *given: changed(columns_of(self, *given))
