"""Quantities that are told, beside their true values; names that are given, beside what is hidden."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.balance.parameter import Parameter
from bench.diagnose.diagnosis import Diagnosis
from bench.diagnose.found import NamedEffect
from bench.effects.effect import Effect
from bench.validate.case import Case

#: Terms of the equation of motion that are judged.
TERMS = (INERTIA, VISCOUS, COULOMB)


@dataclass(frozen=True)
class Scored:
    """One quantity that is told, beside the truth.

    Attributes:
        by: identify or diagnose.
        effect: that it belongs to, empty for J, K_w and K_0.
        quantity: its name; of J, K_w and K_0 the term of the equation of motion.
        true: an angle's within half a turn of what is told - the parameter's unit.
        scale: that errors are told over: the true value's size; 1 of an angle or where that is zero.
        parameter: what is told.
    """

    by: str
    effect: str
    quantity: str
    true: float
    scale: float
    parameter: Parameter

    @property
    def error(self) -> float:
        """Told less true, over the scale."""
        return (self.parameter.value - self.true) / self.scale

    @property
    def half_width(self) -> float:
        """Of the interval of 95 %, over the scale."""
        return self.parameter.half_width / self.scale

    def inside(self, level: float) -> bool:
        """Whether the interval of a level holds the truth."""
        low, high = self.parameter.interval(level)
        return bool(low <= self.true <= high)


def base(by: str, case: Case, parameters: Mapping[str, Parameter]) -> Iterator[Scored]:
    """J, K_w and K_0, those that are told.

    Args:
        by: identify or diagnose.
        case: with the truth.
        parameters: by the names of the contract.
    """
    truth = (case.axis.inertia, case.axis.viscous, case.axis.coulomb)
    for term, true in zip(TERMS, truth, strict=True):
        name = case.rig.axis_kind.parameter(term)
        if name in parameters:
            yield Scored(by, "", term, true, true, parameters[name])


def of_effects(case: Case, diagnosis: Diagnosis) -> Iterator[Scored]:
    """Quantities of the effects that are named and hidden; not whole numbers, which have no interval."""
    hidden = {effect.name: effect.quantities(case.axis) for effect in case.effects}
    for named in diagnosis.effects:
        truth = hidden.pop(named.name, {})
        angles = {quantity.name for quantity in named.effect.quantities if quantity.angle}
        for name, parameter in named.parameters.items():
            if name in truth and parameter.std_error > 0.0 and name not in _integers(named.effect):
                true = truth[name]
                if name in angles:
                    true = parameter.value + math.remainder(true - parameter.value, 2.0 * np.pi)
                scale = 1.0 if name in angles or true == 0.0 else abs(true)
                yield Scored("diagnose", named.name, name, true, scale, parameter)


def _integers(effect: Effect) -> set[str]:
    return {shape.quantity.name for shape in effect.shapes if shape.whole}


@dataclass(frozen=True)
class Named:
    """What a diagnosis says.

    Attributes:
        verdict: as the contract has it; empty if there is none.
        names: that it gives.
        false: of these, what is not hidden. A name counts as another that, by what is said, it is not told from.
        missed: of what is hidden, what it does not name.
        reason: why there is no diagnosis.
    """

    verdict: str = ""
    names: tuple[str, ...] = ()
    false: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()
    reason: str = ""

    @classmethod
    def of(cls, verdict: str, named: Sequence[NamedEffect], hidden: Sequence[str]) -> Named:
        """Names held against what is hidden; one that is given twice is hidden once."""
        left, false = list(hidden), []
        for effect in named:
            matched = next((name for name in (effect.name, *effect.ambiguous_with) if name in left), None)
            if matched is None:
                false.append(effect.name)
            else:
                left.remove(matched)
        return cls(verdict, tuple(effect.name for effect in named), tuple(false), tuple(left))

    @property
    def exact(self) -> bool:
        """Whether the names are those of what is hidden."""
        return bool(self.verdict) and not self.false and not self.missed
