"""A published MJCF compared with a log, joint by joint: what it states, what the log shows, and what it lacks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from bench.axis_kind import ARMATURE, COULOMB, VISCOUS
from bench.joints.identified import IdentifiedJoint
from bench.parameter import Parameter
from bench.plant.mjcf_file import read_mjcf

#: Share of the log's value by which that of the MJCF may be beyond its interval: parts of one type differ as much.
NEAR = 0.1
UNKNOWN = "unknown effect"


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
    """A joint of an MJCF held against a log.

    Attributes:
        numbers: by the names of the MJCF: armature, damping, frictionloss.
        lacks: names of effects that the log shows and the MJCF cannot have or does not have; None where the log does
            not decide on them.
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
    model = read_mjcf(mjcf, stand)[0].compile()
    found = {}
    for name, joint in joints.items():
        dof, ratio = model.joint(name).dofadr[0], 1.0
        if joint.rig is not None and joint.rig.load is not None:
            ratio = joint.rig.load.gear_ratio
        told = {"armature": (ARMATURE, 1.0), "damping": (VISCOUS, ratio**2), "frictionloss": (COULOMB, ratio)}
        numbers = {
            key: Stated(float(getattr(model, f"dof_{key}")[dof].flat[0]), _at_joint(joint, parameter, factor))
            for key, (parameter, factor) in told.items()
        }
        sprung = bool(model.joint(name).stiffness[0])
        found[name] = GradedJoint(numbers, _lacks(joint, sprung))
    return found


def _at_joint(joint: IdentifiedJoint, name: str, factor: float) -> Parameter | None:
    """A parameter times a factor; None where the joint has none that is determined."""
    if joint.rig is None:
        return None
    found = joint.parameters.get(name if name == ARMATURE else joint.rig.axis_kind.parameter(name))
    if found is None:
        return None
    low, high = found.ci95
    return replace(
        found, value=factor * found.value, std_error=factor * found.std_error, ci95=(factor * low, factor * high)
    )


def _lacks(joint: IdentifiedJoint, sprung: bool) -> tuple[str, ...] | None:
    """Names of effects that were found, and an unknown one where a residual remains; of no spring that is stated."""
    if joint.diagnosis is None:
        return None
    names = tuple(each.name for each in joint.diagnosis.effects if not (sprung and each.effect.spring))
    return names + ((UNKNOWN,) if joint.diagnosis.verdict == "unexplained_remainder" else ())
