"""What a nuisance is: one way in which the world damages a recording, and which answers to it are right."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from bench.validation.independent.references import Motion, random_motion
from bench.validation.independent.rig import Axis
from tests.studies.nuisance.signals import Signals, sampled

if TYPE_CHECKING:
    from tests.studies.nuisance.answer import Answer

Strength = float | str
#: Length of a recording unless a nuisance is about it - s.
DURATION = 4.0
#: Sample period unless a nuisance is about it - s.
PERIOD = 1e-3
#: Error of J from which on an answer without a failed check is wrong, relative.
INERTIA_ERROR = 0.01


class Nuisance:
    """Nothing is wrong: the control that each nuisance is held against.

    A nuisance overrides what it is about: the motion, the exact signals before sampling, the sampling, the columns in
    the file, or the rig. What it does not override is sound.

    Attributes:
        strengths: two at least, as each hook gets them.
        unit: of a strength, for the table.
        refusal_is_right: whether so much is lost that a refusal (exit 1 or 2) is right too.
        remainder_is_right: whether an unexplained remainder without a name is right too: no catalogue effect is the
            disturbance, or it buries what is hidden.
        right_names: names that are right beside what is hidden, since the measurement's fault is one of the catalogue.
        unsuited: effects that are not hidden, since this nuisance takes away or imitates all that shows them.
        inertia_error: of J that is no error, relative; more where the rig itself says so.
    """

    strengths: ClassVar[Sequence[Strength]] = ("1", "2")
    unit: ClassVar[str] = ""
    refusal_is_right: ClassVar[bool] = False
    remainder_is_right: ClassVar[bool] = False
    right_names: ClassVar[frozenset[str]] = frozenset()
    unsuited: ClassVar[frozenset[str]] = frozenset()
    inertia_error: ClassVar[float] = INERTIA_ERROR

    def motion(self, axis: Axis, strength, rng: np.random.Generator) -> Motion:
        """What the axis is commanded to do."""
        return random_motion(axis, rng, DURATION)

    def exact(self, fine: Signals, strength, axis: Axis, rng: np.random.Generator) -> Signals:
        """Exact signals, every control period, as they reach the electronics."""
        return fine

    def sampled(self, fine: Signals, strength, rng: np.random.Generator) -> Signals:
        """What the recorder takes of them."""
        return sampled(fine, PERIOD)

    def in_file(self, signals: Signals, strength, axis: Axis, rng: np.random.Generator) -> Signals:
        """What of them, noise and all, reaches the file."""
        return signals

    def known(self, axis: Axis, strength) -> Axis:
        """The axis as its rig file has it."""
        return axis

    def rig_text(self, text: str, axis: Axis, strength) -> str:
        """The rig file's text."""
        return text

    def reported(self, answer: Answer) -> bool:
        """Whether an answer says that J is off for what the rig got wrong, without refusing."""
        return False


def named(nuisance: Nuisance) -> str:
    """A nuisance's name in tables and on the command line, as `position-wrapped`."""
    kind = type(nuisance).__name__
    return "".join(f"-{letter.lower()}" if letter.isupper() else letter for letter in kind).lstrip("-")


def label(nuisance: Nuisance, strength: Strength) -> str:
    """A strength as the table tells it."""
    text = strength if isinstance(strength, str) else f"{strength:g}"
    return f"{text} {nuisance.unit}".strip()
