"""Estimated quantities beside their true values; names beside the hidden effects."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.name import NamedEffect
from bench.parameter import Parameter
from bench.validation.independent.effects import Effect as Hidden
from bench.validation.independent.rig import Axis
from bench.validation.plan import Case

#: Terms of the equation of motion that are judged.
TERMS = (INERTIA, VISCOUS, COULOMB)


@dataclass(frozen=True)
class Scored:
    """One estimated quantity beside its true value.

    Attributes:
        by: identify or diagnose.
        effect: that it belongs to, empty for J, K_w and K_0.
        quantity: its name; of J, K_w and K_0 the term of the equation of motion.
        true: true value; of an angle within half a turn of the estimate - the parameter's unit.
        scale: of errors: magnitude of the true value; 1 for an angle or zero.
        parameter: the estimate.
    """

    by: str
    effect: str
    quantity: str
    true: float
    scale: float
    parameter: Parameter

    @property
    def error(self) -> float:
        """Estimate less true value, over the scale."""
        return (self.parameter.value - self.true) / self.scale

    @property
    def half_width(self) -> float:
        """Half width of the interval of 95 %, over the scale."""
        return self.parameter.half_width / self.scale

    def inside(self, level: float) -> bool:
        """Whether the interval of a level contains the true value."""
        low, high = self.parameter.interval(level)
        return bool(low <= self.true <= high)


def base(by: str, case: Case, parameters: Mapping[str, Parameter]) -> Iterator[Scored]:
    """J, K_w and K_0, as far as they are determined, by identify or diagnose; parameters by the contract's names."""
    truth = (case.axis.inertia, case.axis.viscous, case.axis.coulomb)
    for term, true in zip(TERMS, truth, strict=True):
        name = case.rig.axis_kind.parameter(term)
        if name in parameters:
            yield Scored(by, "", term, true, true, parameters[name])


def of_effects(effects: Iterable[Hidden], axis: Axis, diagnosis: Diagnosis) -> Iterator[Scored]:
    """Quantities of the effects that are named and hidden in an axis, without integers, which have no interval."""
    hidden = {effect.name: effect.quantities(axis) for effect in effects}
    for named in diagnosis.effects:
        truth = hidden.pop(named.name, {})
        angles = {quantity.name for quantity in named.effect.quantities if quantity.angle}
        integers = {shape.quantity.name for shape in named.effect.shapes if shape.whole}
        for name, parameter in named.parameters.items():
            if name in truth and parameter.std_error > 0.0 and name not in integers:
                true = truth[name]
                if name in angles:
                    true = parameter.value + math.remainder(true - parameter.value, 2.0 * np.pi)
                scale = 1.0 if name in angles or true == 0.0 else abs(true)
                yield Scored("diagnose", named.name, name, true, scale, parameter)


@dataclass(frozen=True)
class Named:
    """The names of a diagnosis.

    Attributes:
        verdict: as the contract has it; empty if there is none.
        names: those given.
        false: of these, those not hidden. A name matches effects that it is reported to be ambiguous with.
        missed: hidden effects that are not named.
        reason: why there is no diagnosis.
    """

    verdict: str = ""
    names: tuple[str, ...] = ()
    false: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()
    reason: str = ""

    @classmethod
    def of(cls, verdict: str, named: Sequence[NamedEffect], hidden: Sequence[str]) -> Named:
        """Names compared with the hidden effects; a name that is given twice matches only one."""
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
        """Whether the names are exactly those of the hidden effects."""
        return bool(self.verdict) and not self.false and not self.missed


Status = Literal["done", "refused", "failed"]


@dataclass(frozen=True)
class Run:
    """One run.

    Attributes:
        index, plant, motion, kind, hidden, severity: as drawn.
        noise: of speed and current, as white/hum.
        sample_period, duration: of the recording - s.
        status: done; refused by `identify`, which tells what it knows all the same; failed where there is no recording.
        reason: why it is not done.
        scored: quantities, by `identify` and by `diagnose`.
        named: by `diagnose`, if it was asked.
    """

    index: int
    plant: str
    motion: str
    kind: str
    noise: str
    sample_period: float
    duration: float
    hidden: tuple[str, ...]
    severity: float
    status: Status = "done"
    reason: str = ""
    scored: tuple[Scored, ...] = ()
    named: Named | None = None
