"""A published MJCF compared with a log, joint by joint: what it states, what the log shows, and what it lacks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from bench.axis_kind import ARMATURE, COULOMB, VISCOUS
from bench.export.mjcf import compiled
from bench.joints.identified import IdentifiedJoint
from bench.parameter import Parameter
from bench.plant.mjcf_file import read_mjcf

#: Share of the log's value by which that of the MJCF may be beyond its interval: parts of one type differ as much.
NEAR = 0.1
UNKNOWN = "unknown effect"
#: Of a joint in an MJCF.
NUMBERS = ("armature", "damping", "frictionloss")


@dataclass(frozen=True)
class Stated:
    """A number of a joint, on the joint's side of its gear.

    Attributes:
        value: in the MJCF - SI.
        found: by the log; None where it does not determine it.
    """

    value: float
    found: Parameter | None

    @property
    def near(self) -> bool | None:
        """Whether the MJCF agrees with the log; None where the log does not determine it."""
        if self.found is None:
            return None
        (low, high), beyond = self.found.ci95, NEAR * abs(self.found.value)
        return low - beyond <= self.value <= high + beyond


@dataclass(frozen=True)
class GradedJoint:
    """A joint of an MJCF compared with a log.

    Attributes:
        numbers: by the names of the MJCF: armature, damping, frictionloss.
        lacks: names of effects that the log shows and the MJCF does not have; None where the log does not decide.
    """

    numbers: Mapping[str, Stated]
    lacks: tuple[str, ...] | None

    @property
    def agrees(self) -> bool | None:
        """Whether all that the log determines is near, and no effect is missing; None where it determines nothing."""
        near = [each.near for each in self.numbers.values() if each.near is not None]
        return all(near) and not self.lacks if near else None


def graded(mjcf: Path, joints: Mapping[str, IdentifiedJoint], stand: bool) -> dict[str, GradedJoint]:
    """Joints of an MJCF, with a floating base fixed or not, by their logs."""
    model, grades = compiled(read_mjcf(mjcf, stand)[0]), {}
    for name, joint in joints.items():
        own, found = model.joint(name), dict(zip(NUMBERS, _at_joint(joint), strict=True))
        numbers = {key: Stated(float(getattr(own, key).flat[0]), number) for key, number in found.items()}
        grades[name] = GradedJoint(numbers, _lacks(joint, sprung=bool(own.stiffness[0])))
    return grades


def _at_joint(joint: IdentifiedJoint) -> list[Parameter | None]:
    """NUMBERS by the log, on the joint's side; None for one that is not determined."""
    if joint.rig is None:
        return [None] * len(NUMBERS)
    kind, ratio = joint.rig.axis_kind, joint.rig.gear_ratio
    factors = {ARMATURE: 1.0, kind.parameter(VISCOUS): ratio**2, kind.parameter(COULOMB): ratio}
    found = {name: joint.parameters.get(name) for name in factors}
    return [one and one.times(factors[name]) for name, one in found.items()]


def _lacks(joint: IdentifiedJoint, sprung: bool) -> tuple[str, ...] | None:
    """Names of effects that were found, and an unknown one where a residual remains; of no spring that is stated."""
    if joint.diagnosis is not None:
        names = tuple(each.name for each in joint.diagnosis.effects if not (sprung and each.effect.spring))
    elif joint.servo is not None:
        names = tuple(joint.servo.found.effects)
    else:
        return None
    return names + ((UNKNOWN,) if joint.verdict == "unexplained_remainder" else ())
