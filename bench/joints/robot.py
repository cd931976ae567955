"""A robot by its logs: every joint within the rest, joints in parallel on processes, and the MJCF with all of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from bench.axis_kind import ARMATURE
from bench.effects.present import named
from bench.errors import BenchError, InputError, UndeterminedError
from bench.export.mjcf import Armature, PositionDrive, robot_with
from bench.jobs.process import Failure
from bench.joints.goals import GivenGain, by_goals, drive_of, with_gains, with_one_delay
from bench.joints.grade import GradedJoint, graded
from bench.joints.identified import IdentifiedJoint, JointLogs, identified, of_each
from bench.joints.links import FoundPayload, carrying, doubted, reversed_joints, seek_payload
from bench.names import meant, nearest, with_known_arguments
from bench.parameter import Parameter
from bench.plant.model_file import StoredModel
from bench.plant.robot import AddedBody, Change, joint_units
from bench.presented import Shown
from bench.rig.given import GivenRig, rig_of

#: Joints at most whose links' motion behind soft or loose gears is taken into account.
MOST_LOOSE = 3
#: Share of the progress in which a payload is sought.
SEEKING = 0.3


@dataclass(frozen=True)
class IdentifiedRobot(Shown):
    """The result of logs for a robot.

    Attributes:
        mjcf: its file.
        joints: each by its name, in the order of the MJCF.
        payload: what a body carried in the logs, where that was sought and is determined.
        links: inertia of those that are not the MJCF's over it, by joint; joints are reported with what theirs is.
        warnings: what concerns no joint alone.
        added: what the joints were identified with in addition to the MJCF.
        stand: whether a floating base was fixed.
        zeros: by joint, what is added to the log's position for that of the MJCF, where that is not zero - rad (m).
    """

    mjcf: Path
    joints: Mapping[str, IdentifiedJoint]
    payload: FoundPayload | None = None
    links: Mapping[str, Parameter] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    added: tuple[Change, ...] = ()
    stand: bool = False
    zeros: Mapping[str, Parameter] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"IdentifiedRobot({self.mjcf.name}: {len(self.answered)} of {len(self.joints)} joints are identified)"

    def __getitem__(self, joint: str) -> IdentifiedJoint:
        return meant(joint, self.joints)

    @property
    def answered(self) -> tuple[str, ...]:
        """Names of the joints of which anything is determined."""
        return tuple(name for name, joint in self.joints.items() if joint.parameters)

    @property
    def models(self) -> dict[str, StoredModel]:
        """Of the joints that have one, by name."""
        models = {name: joint.model for name, joint in self.joints.items()}
        return {name: model for name, model in models.items() if model is not None}

    @property
    def drives(self) -> dict[str, PositionDrive]:
        """Position controllers of the joints that were found by goals, by name."""
        return {name: drive for name, joint in self.joints.items() if (drive := drive_of(joint)) is not None}

    @property
    def actuators(self) -> dict[str, dict[str, float]]:
        """The same with the armature and friction that they move, as `bench.export.actuator` takes them."""
        found, models = dict[str, dict[str, float]](), self.models
        for name, drive in self.drives.items():
            if name not in models:
                continue
            own, links = models[name].model.parameters, models[name].mounting.link_inertia
            found[name] = {
                "kp": drive.kp,
                "kv": drive.kd,
                "delay": drive.delay,
                "armature": max(own.inertia - links, 0.0),
                "damping": own.viscous_friction_coefficient,
                "frictionloss": own.coulomb_friction,
            } | ({"forcerange": drive.limit} if math.isfinite(drive.limit) else {})
        return found

    @property
    def grade(self) -> dict[str, GradedJoint]:
        """The joints as the MJCF states them, each held against the logs."""
        return graded(self.mjcf, self.joints, self.stand)

    def with_joints(self, out: Path) -> tuple[str, tuple[str, ...]]:
        """Text of the MJCF with the models of the joints and the rest of it, and what went onto each in sentences.

        InputError where MuJoCo cannot have it.
        """
        models = {}
        for name, model in self.models.items():
            found = self.joints[name].parameters.get(ARMATURE)
            origin = "; ".join(filter(None, ["all that moved but the links", self.joints[name].contested]))
            armature = None if found is None else Armature(max(found.value, 0.0), origin)
            models[name] = model, armature
        kept = [name for name in self.joints if name not in models]
        return robot_with(self.mjcf, models, out, self.added, kept, stand=self.stand, drives=self.drives)


@with_known_arguments
def robot(
    logs: str | Path | Sequence[str | Path],
    mjcf: str | Path | Sequence[str | Path],
    holdout: str | Path | None = None,
    rig: GivenRig | None = None,
    joints: str | Sequence[str] = (),
    stated: Mapping[str, float] | None = None,
    excluded: str | Collection[str] = (),
    payload: AddedBody | str | None = None,
    progress: Callable[[float], None] = lambda share: None,
    stand: bool = False,
    kp: GivenGain = None,
    kd: GivenGain = None,
    compare: bool = False,
) -> IdentifiedRobot:
    """Identify and diagnose every joint of a robot, each within the rest of it; one that fails does not affect the
    others.

    Args:
        logs: one log of all joints, or several that each move a few.
        mjcf: of the robot; of one whose payload differs from log to log one for each, the holdout's last. Armature and
            friction are those of all logs, and results are written into the first.
        holdout: another log, not used to fit.
        rig: what is known of the joints' drives, as `identify` takes it; not needed where the logs hold torque.
        joints: names of those to identify; all hinges and slides of the MJCF where none is given.
        stated: positions of joints that stand and that the logs do not hold - rad (m).
        excluded: effects that are not tried.
        payload: that a body carried in the logs, or the name of a body whose payload is sought.
        progress: called with the share done.
        stand: whether a floating base is fixed where the MJCF has it.
        kp, kd: gains of position controllers at the joints, where the logs hold goals and no efforts - N*m/rad (N/m),
            N*m*s/rad (N*s/m) -: of all, or of each by its name; by default those of the MJCF's position actuators.
        compare: whether friction models M1 to M6 of each joint are compared.

    Raises:
        InputError: no log, an MJCF that cannot be read, or a joint that it does not have.
    """
    paths = _paths(logs)
    known = None if rig is None else rig_of(rig)
    joints = [joints] if isinstance(joints, str) else joints
    left_out = frozenset(named(one, "excluded").name for one in ([excluded] if isinstance(excluded, str) else excluded))
    unseen = None if holdout is None else Path(holdout)
    first, others = _mjcfs(mjcf, [*paths, *([] if unseen is None else [unseen])])
    names = _required(first, joints)
    asked = [name for name in names if not joints or name in joints]
    known_of_all = unseen, known, stated or {}, left_out, (), stand, others
    of_all = JointLogs("", first, tuple(paths), *known_of_all, compare=compare)
    work = with_gains([replace(of_all, joint=name) for name in asked], kp, kd)
    return _answered(of_all, work, payload, progress)


def _answered(
    of_all: JointLogs, work: list[JointLogs], payload: AddedBody | str | None, progress: Callable[[float], None]
) -> IdentifiedRobot:
    """All joints, with a payload that is known or sought, and again where links have another inertia.

    `of_all` is the task of each, but for its name.
    """
    sought, warnings = None, list[str]()
    if isinstance(payload, str):
        try:
            sought = seek_payload(work, payload, lambda share: progress(SEEKING * share))
        except UndeterminedError as error:
            warnings.append(str(error))
    added = sought.added if sought is not None else payload
    work = carrying(work, [added]) if isinstance(added, AddedBody) else work
    found = _identified(work, lambda share: progress(SEEKING + (1.0 - SEEKING) * share))
    for _ in range(MOST_LOOSE):
        tried = [_with_links(work, found, name, progress) for name in _loose(found, work)]
        gains = [_explained(found, after) for _, after in tried]
        if max(gains, default=0.0) <= 0.0:
            break
        work, found = tried[gains.index(max(gains))]
    unlike = _open(found) or any(one.failed for one in found.values())
    turned = reversed_joints(work) if unlike else []
    if turned:
        work = carrying(work, turned)
        found = _identified(work, progress)
    open_ = _open(found)
    # behind a soft gear the lag of a link looks like more of its inertia, or of its neighbours'
    links, zeros = dict[str, Parameter](), dict[str, Parameter]()
    if open_ and not any(one.twists for one in found.values()):
        work, links, zeros = doubted(work)
    if links or zeros:
        found = _identified(work, progress)
    added = work[0].added if work else ()
    warnings += [
        f"{one.joint}: the log counts position, speed and torque in the opposite direction to the MJCF. The joint is "
        "identified with its axis reversed; to keep the MJCF's axis, put `sign = -1` under "
        f"[joints.{one.joint}] in a rig"
        for one in turned
    ]
    warnings += [
        f"{joint}: the log has another zero than the MJCF, whose position is the log's + "
        f"({zero.value:.4g} ± {zero.half_width:.2g} {zero.unit}). "
        "The joint is identified with it, and `robot_id.xml` has it as `ref`"
        for joint, zero in zeros.items()
    ]
    return IdentifiedRobot(of_all.mjcf, found, sought, links, tuple(warnings), added, of_all.stand, zeros)


def _open(found: Mapping[str, IdentifiedJoint]) -> list[IdentifiedJoint]:
    """Joints with a residual that no effect explains."""
    return [one for one in found.values() if one.diagnosis and one.diagnosis.verdict == "unexplained_remainder"]


def _loose(found: Mapping[str, IdentifiedJoint], work: Sequence[JointLogs]) -> list[str]:
    """Joints with a soft or loose gear whose links' motion is not taken into account."""
    known = {name for twists in work[0].twists.values() for name in twists}
    return [name for name, joint in found.items() if joint.twists and name not in known]


def _with_links(
    work: Sequence[JointLogs], found: Mapping[str, IdentifiedJoint], name: str, progress: Callable[[float], None]
) -> tuple[list[JointLogs], dict[str, IdentifiedJoint]]:
    """All joints with the motion of one's links, which no encoder measures and all feel."""
    known = work[0].twists
    twists = {log: {**known.get(log, {}), name: twist} for log, twist in found[name].twists.items()}
    more = [replace(asked, twists=twists) for asked in work]
    return more, _identified(more, progress)


def _explained(before: Mapping[str, IdentifiedJoint], after: Mapping[str, IdentifiedJoint]) -> float:
    """Logarithms of how far residuals of all joints fell, summed: which gear is soft shows where all are explained."""
    fell = [(_left(one), _left(after[name])) for name, one in before.items()]
    if any(last is None for first, last in fell if first is not None):
        return -math.inf
    return sum(math.log(first / max(last, 1e-300)) for first, last in fell if first is not None and last is not None)


def _left(joint: IdentifiedJoint) -> float | None:
    """RMS residual of a joint with its effects; None of one that has no diagnosis."""
    gap = None if joint.diagnosis is None else joint.diagnosis.torque.final
    return None if gap is None else gap[1]


def _mjcfs(mjcf: str | Path | Sequence[str | Path], logs: Sequence[Path]) -> tuple[Path, dict[Path, Path]]:
    """The first MJCF, and those of logs that have another one; InputError where neither one nor one each is given."""
    every = [Path(mjcf)] if isinstance(mjcf, str | Path) else list(map(Path, mjcf))
    if len(every) == 1:
        return every[0], {}
    if len(every) != len(logs):
        allowed = "allowed: one for all, or one for each in their order, the holdout's last"
        raise InputError("--mjcf", f"found {len(every)} MJCF files for {len(logs)} logs", allowed)
    return every[0], {log: one for log, one in zip(logs, every, strict=True) if one != every[0]}


def _paths(logs: str | Path | Sequence[str | Path]) -> list[Path]:
    """Of one log or several; InputError where there is none, or something else."""
    every = [*logs] if isinstance(logs, list | tuple) else [logs]
    wrong = next((type(log).__name__ for log in every if not isinstance(log, str | Path)), None if every else "none")
    if wrong is not None:
        allowed = 'allowed: paths of files; of a data frame, frame.to_csv("log.csv")'
        raise InputError("logs", f"found {wrong}", allowed)
    return [Path(str(log)) for log in every]


def _required(mjcf: Path, joints: Sequence[str]) -> list[str]:
    """Names of the hinges and slides of an MJCF; InputError where one that is asked for is not among them."""
    names = list(joint_units(mjcf))
    for name in joints:
        if name not in names:
            unknown = f"found no hinge or slide of that name{nearest(name, names)}"
            raise InputError(f"--joint {name}", unknown, f"allowed: {', '.join(names) or 'an MJCF with a named joint'}")
    return names


def _identified(work: Sequence[JointLogs], progress: Callable[[float], None]) -> dict[str, IdentifiedJoint]:
    """Each joint by its name; BenchError where several fail, all for one reason that concerns the MJCF."""
    found: dict[str, IdentifiedJoint] = {}
    by = by_goals if any(asked.goals for asked in work) else identified
    for asked, one in zip(work, of_each(by, work, progress), strict=True):
        found[asked.joint] = IdentifiedJoint(asked.joint, failed=one.reason) if isinstance(one, Failure) else one
    reasons = {joint.failed for joint in found.values()}
    if len(found) > 1 and len(reasons) == 1 and any(reason.startswith(str(work[0].mjcf)) for reason in reasons):
        raise BenchError(*reasons)
    return with_one_delay(found)
