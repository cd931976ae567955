"""One joint of a robot, as far as logs determine it: a refusal does not affect the rest."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import TypeVar

import numpy as np

from bench.arrays import rms
from bench.axis_kind import ARMATURE, COULOMB, INERTIA, VISCOUS, AxisKind
from bench.diagnosis.diagnosis import Diagnosis, diagnose
from bench.effects.catalogue import catalogue
from bench.errors import BenchError, InputError, UndeterminedError
from bench.fit.determined import refused_masses
from bench.fit.estimate import Estimate, RefusedEstimateError
from bench.fit.hypothesis import seen_by
from bench.fit.identify import identify
from bench.fit.rows import Rows
from bench.gate.check import Check
from bench.gate.gate import passed, warnings_of
from bench.jobs.each import each
from bench.jobs.process import Failure, Limits
from bench.joints.friction_models import FrictionModel, friction_models
from bench.joints.weight import constant_of, counted_differently, needs_constant, require_counted, with_constant
from bench.names import meant, words
from bench.parameter import Parameter
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.model_file import Mounting, StoredModel
from bench.plant.robot import Change, Poses, Robot, Twist, joint_rig, read_along
from bench.presented import ByKey, ByName
from bench.rig.rig import Rig
from bench.servos.breakaway import StaticFriction
from bench.servos.commanded import Coefficients, Gains
from bench.servos.servo import Servo
from bench.trace.trace import Trace
from bench.view.joint_motion import JointMotion, joint_motion

Told = TypeVar("Told")
#: Recordings of a joint, with the robot's poses along each, and why others cannot be read, by their files.
Read = tuple[dict[Path, tuple[Trace, Poses]], dict[Path, BenchError]]
#: Of one joint: ten times what the longest log tried took (600 s at 500 Hz).
LIMITS = Limits(deadline=1800.0, memory=8.0 * 1024**3)
#: Share of the links' inertia, and of the largest torque, below which armature and friction may be none.
LITTLE = 0.05
#: Name of the torque (force) constant among the parameters, N*m/A (N/A).
CONSTANT = "torque_constant"
#: Key of a refusal that concerns no parameter: whether anything is missing.
EFFECTS = "effects"


@dataclass(frozen=True)
class JointLogs:
    """The task of one joint: logs that are fitted, one that is not, and what else is known.

    Attributes:
        joint: its name in the MJCF.
        mjcf, logs, holdout: files.
        compare: whether friction models are compared.
        mjcfs: of the logs in which the robot had another payload, by their files.
        rig: of the joints; None where nothing is known of them.
        stated: positions of joints that stand and that the logs do not hold - rad (m).
        excluded: effects that are not tried.
        added: what the robot has in addition to its MJCF.
        stand: whether a floating base is fixed.
        goals: whether the logs hold goals of position controllers instead of efforts.
        gains: of the joint's controller, where they are known.
        twists: of links behind soft or loose gears in each log, where they are known.
    """

    joint: str
    mjcf: Path
    logs: tuple[Path, ...]
    holdout: Path | None = None
    rig: Rig | None = None
    stated: Mapping[str, float] = field(default_factory=dict)
    excluded: frozenset[str] = frozenset()
    added: tuple[Change, ...] = ()
    stand: bool = False
    mjcfs: Mapping[Path, Path] = field(default_factory=dict)
    goals: bool = False
    gains: Gains | None = None
    compare: bool = False
    twists: Mapping[Path, Mapping[str, Twist]] = field(default_factory=dict)

    def robot(self) -> Robot:
        """The robot around the joint; InputError as `Robot.of`."""
        return Robot.of(self.mjcf, self.joint, self.added, self.stand)

    def robot_of(self, log: Path) -> Robot:
        """The robot as it was in a log, its load in addition to the same inertia in all; InputError as `Robot.of`."""
        first = self.robot()
        if log in self.mjcfs:
            first = replace(Robot.of(self.mjcfs[log], self.joint, self.added, self.stand), datum=first.inertia)
        return replace(first, twists=self.twists.get(log, {}))


@dataclass(frozen=True)
class Goals:
    """What goals and positions show of a joint.

    Attributes:
        found: the coefficients of its balance.
        link_inertia: of its links in the configuration of the MJCF - kg*m**2 (kg).
        static: its static friction, where that is determined.
        seldom: why it is not, and what to record instead.
        doubt: by how much the weight of the links contradicts the gains; empty where it does not.
    """

    found: Coefficients
    link_inertia: float
    static: StaticFriction | None
    seldom: tuple[str, str]
    doubt: str


@dataclass(frozen=True)
class IdentifiedJoint(ByName):
    """The result of logs for a joint.

    Attributes:
        name: in the MJCF.
        rig: with the MJCF's values of its links; None where the MJCF or the logs do not contain the joint.
        diagnosis: with effects; None where the logs do not decide on them.
        estimate: inertia and friction only, where there is no diagnosis; None where they are not determined.
        refused: why a parameter, or whether anything is missing, is not determined, by its name.
        record: the motion that would determine it; empty where nothing is refused.
        left_out: why a log was not used, by its file.
        failed: what is wrong with the input, if that is why nothing is determined.
        motion: of a diagnosis with a model that moves.
        payloads: whether the links' inertia differs from log to log.
        friction_models: compared, where that was asked for and a known load moves.
        constant: torque (force) constant by the weight of the links, of logs that hold a current and no rig that states
            it.
        goals: what they show, where the torque followed from goals.
        servo: fitted to goals and positions, where the gains were not known.
        twists: of its links against the motor in each log, where an effect couples them.
    """

    name: str
    rig: Rig | None = None
    diagnosis: Diagnosis | None = None
    estimate: Estimate | None = None
    refused: Mapping[str, str] = field(default_factory=dict)
    record: str = ""
    left_out: Mapping[str, str] = field(default_factory=dict)
    failed: str = ""
    motion: JointMotion | None = None
    payloads: bool = False
    constant: Parameter | None = None
    goals: Goals | None = None
    servo: Servo | None = None
    twists: Mapping[Path, Twist] = field(default_factory=dict)
    friction_models: tuple[FrictionModel, ...] = ()

    def __getitem__(self, name: str) -> Parameter:
        return meant(name, self.parameters)

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Those that are determined, by name."""
        found = self.servo or self.diagnosis or self.estimate
        parameters = {} if found is None else found.parameters
        known = {name: parameter for name, parameter in parameters.items() if name not in self.refused}
        return ByKey(known if self.constant is None else {**known, CONSTANT: self.constant})

    @property
    def checks(self) -> tuple[Check, ...]:
        """Of the logs, before anything was fitted."""
        found = self.servo or self.diagnosis or self.estimate
        return () if found is None else found.checks

    @property
    def verdict(self) -> str | None:
        """Whether anything is missing; None where that is not determined."""
        found = self.servo or self.diagnosis
        return None if found is None else found.verdict

    @property
    def warnings(self) -> list[str]:
        """What a user should know before relying on it."""
        found = self.servo or self.diagnosis or self.estimate
        warnings = () if found is None else (*found.warnings, *warnings_of(found.checks))
        warnings = (*warnings, *([f"contested armature: {self.contested}"] if self.contested else []))
        return [*warnings, *(f"{log} is not used: {why}" for log, why in self.left_out.items())]

    @property
    def contested(self) -> str:
        """What else the armature may be, as a scale of the torque looks like other links; empty if it is clear.

        So it is where a known payload differs from log to log.
        """
        armature = self.parameters.get(ARMATURE)
        if armature is None or self.payloads:
            return ""
        for one in self.diagnosis or ():
            if one.effect.rescales_torque:
                (scale,) = one.values.values()
                return (
                    f"the reported torque counts as {scale:.3g} times the one that acts; with links {scale:.3g} times "
                    f"as heavy as the MJCF's instead the armature is {scale * armature.value:.4g} {armature.unit}"
                )
            for name in one.ambiguous_with:
                if name in catalogue() and catalogue()[name].rescales_torque:
                    return f"a {words(name)} looks like {words(one.name)}, and would change the armature"
        return ""

    @property
    def model(self) -> StoredModel | None:
        """Of the joint for MuJoCo; without armature where that is not determined; None without friction."""
        if self.rig is not None and _behind(self.rig):
            return None
        if self.diagnosis is not None and self.diagnosis.model is not None:
            return self.diagnosis.model
        if self.rig is None:
            return None
        kind, mounting = self.rig.axis_kind, Mounting.of(self.rig)
        links = mounting.link_inertia / mounting.gear_ratio**2
        if self.servo is not None:
            if not (own := self.servo.found.actuator):
                return None
            axis = AxisModel(AxisParameters(links + own["armature"], own["damping"], own["frictionloss"], kind=kind))
            return StoredModel(self.name, axis, mounting=mounting)
        if not {kind.parameter(VISCOUS), kind.parameter(COULOMB)} <= {*self.parameters}:
            return None
        inertia = self.parameters[kind.inertia].value if kind.inertia in self.parameters else 0.0
        inertia = inertia if inertia > 0.0 or ARMATURE in self.parameters else links
        viscous, coulomb = (max(self.parameters[kind.parameter(term)].value, 0.0) for term in (VISCOUS, COULOMB))
        if inertia <= 0.0:
            return None
        axis = AxisModel(AxisParameters(inertia, viscous, coulomb, kind=kind))
        return StoredModel(self.name, axis, mounting=mounting)


def identified(asked: JointLogs) -> IdentifiedJoint:
    """The joint by its logs; what is wrong with them, or what they do not determine, is in it."""
    try:
        robot = asked.robot()
        rig = joint_rig(asked.rig, robot)
        read, refusals = _read(asked, asked.logs, rig)
        rig, constant = _with_constant(asked.joint, rig, [trace for trace, _ in read.values()])
        unseen = [] if asked.holdout is None else [asked.holdout]
        found = diagnosed(asked, rig, (read, refusals), lambda: _read(asked, unseen, rig))
        return replace(found, constant=constant)
    except UndeterminedError as error:
        return IdentifiedJoint(asked.joint, refused={EFFECTS: error.reason}, record=error.record)
    except BenchError as error:
        return IdentifiedJoint(asked.joint, failed=str(error))


def diagnosed(asked: JointLogs, rig: Rig, logs: Read, holdout: Callable[[], Read]) -> IdentifiedJoint:
    """The joint by what was read of its logs, with efforts; raises where it moves in none of them."""
    used, left_out = _moving(*logs, rig, asked.joint)
    traces, poses = [trace for trace, _ in used.values()], next(iter(used.values()))[1]
    unseen: dict[Path, tuple[Trace, Poses]] = {}
    if asked.holdout is not None:
        try:
            unseen, _ = _moving(*holdout(), rig, asked.joint)
        except BenchError as error:
            left_out[asked.holdout.name] = str(error)
    try:
        other = next((trace for trace, _ in unseen.values()), None)
        found = diagnose(traces, rig, other, asked.excluded)
    except UndeterminedError as refusal:
        return _without_effects(asked.joint, traces, rig, refusal, left_out)
    except BenchError as error:
        return IdentifiedJoint(asked.joint, rig, failed=str(error), left_out=left_out)
    differ = [] if len(used) == 1 else counted_differently({log: trace for log, (trace, _) in used.items()}, rig)
    refused = {**found.refused, **_any_friction(found, rig.axis_kind), **_behind(rig)}
    motion = joint_motion(found, traces[0], rig, poses)
    warnings, models = [*found.warnings, *_frictionless(asked.joint, found, rig), *differ], ()
    if asked.compare:
        try:
            models = friction_models(traces, rig)
        except UndeterminedError as error:
            warnings.append(str(error))
    found = replace(found, warnings=warnings)
    inertia = asked.robot().inertia
    payloads = any(replace(asked.robot_of(log), datum=None).inertia != inertia for log in used)
    return IdentifiedJoint(
        asked.joint,
        rig,
        found,
        refused=refused,
        left_out=left_out,
        motion=motion,
        payloads=payloads,
        friction_models=models,
        twists=_twists(found, {log: trace for log, (trace, _) in (used | unseen).items()}, rig),
    )


def _twists(found: Diagnosis, traces: Mapping[Path, Trace], rig: Rig) -> dict[Path, Twist]:
    """By how much links are ahead of their motor in each log, on the joint's side, if an effect couples them."""
    hypothesis, twists = found.balance.hypothesis, dict[Path, Twist]()
    ratio = rig.load.gear_ratio if rig.load is not None else 1.0
    for (coupling, shape), (log, trace) in product(hypothesis.couplings, traces.items()):
        angle, rate = np.zeros((2, len(trace)))
        for part in seen_by(Rows.of(trace, rig), hypothesis).stretches:
            (column, *_) = coupling.columns(part.signals, shape)
            samples = slice(part.start, part.start + part.signals.time.size)
            twist = next(values for values, order in column if order == 2) / part.signals.heavier
            angle[samples] = twist / ratio
            rate[samples] = np.gradient(angle[samples], trace.sample_period)
        twists[log] = trace.time, angle, rate
    return twists


def of_each(
    told: Callable[[JointLogs], Told], work: Sequence[JointLogs], progress: Callable[[float], None]
) -> list[Told | Failure]:
    """The result of a function for each joint by its logs, side by side on processes."""
    found: dict[int, Told | Failure] = {}
    for place, one in each(told, work, LIMITS):
        found[place] = one
        progress(len(found) / len(work))
    return [found[place] for place in range(len(work))]


def _behind(rig: Rig) -> dict[str, str]:
    """Why there is neither armature nor friction, where the torque is measured on the joint's side."""
    if rig.load is None or not rig.load.behind_rotor:
        return {}
    names = (ARMATURE, *map(rig.axis_kind.parameter, (VISCOUS, COULOMB)))
    return dict.fromkeys(names, "the torque is measured on the joint's side, where rotor, motor and gear are not in it")


def _frictionless(joint: str, found: Diagnosis, rig: Rig) -> Iterator[str]:
    """A warning where armature and friction are zero, within little of the links' inertia and the largest torque."""
    names = (ARMATURE, *map(rig.axis_kind.parameter, (VISCOUS, COULOMB)))
    own = [found.parameters[name] for name in names if name in found.parameters]
    if found.model is None or len(own) < len(names) or any(one.ci95[0] > 0.0 for one in own):
        return
    links, largest = found.model.mounting.link_inertia, found.model.model.peak_effort
    if own[0].ci95[1] < LITTLE * links and own[2].ci95[1] < LITTLE * largest:
        yield (
            "armature and friction are zero, as of a torque that is measured behind the gear. It does not show motor "
            f'and gear: if so, put torque = "joint side" under [joints.{joint}] in a rig'
        )


def _any_friction(found: Diagnosis, kind: AxisKind) -> dict[str, str]:
    """Why a friction is not determined: its interval contains zero and allows more than the measured torque."""
    fitted, refused = found.time_series[0], {}
    for term, reach in ((VISCOUS, rms(fitted.velocity)), (COULOMB, 1.0)):
        one = found.parameters.get(kind.parameter(term))
        if one is not None and one.half_width > abs(one.value) and one.half_width * reach > rms(fitted.torque):
            between = f"{one.ci95[0]:.3g} to {one.ci95[1]:.3g} {one.unit}"
            refused[kind.parameter(term)] = f"its interval, {between}, allows more than the measured {kind.effort}"
    return refused


def _read(asked: JointLogs, logs: Sequence[Path], rig: Rig) -> Read:
    """Recordings of the joint, with the robot's poses along each, and why others cannot be read.

    A current that no constant makes a torque counts as one of 1 N*m/A (N/A).
    """
    read, refused = dict[Path, tuple[Trace, Poses]](), dict[Path, BenchError]()
    rig = with_constant(rig, 1.0) if rig.motor.torque_per_ampere is None else rig
    for log in logs:
        try:
            read[log] = read_along(log, rig, asked.robot_of(log), asked.stated)
        except (InputError, UndeterminedError) as error:
            refused[log] = error
    return read, refused


def _with_constant(joint: str, rig: Rig, traces: Sequence[Trace]) -> tuple[Rig, Parameter | None]:
    """The rig with a torque (force) constant by the weight of the links, where the joint's efforts need one.

    UndeterminedError where the weight does not determine it.
    """
    currents = [trace for trace in traces if needs_constant(rig, trace)]
    if not currents:
        return rig, None
    try:
        return constant_of(currents, rig)
    except UndeterminedError as error:
        record = f"{error.record}, or state torque_constant under [joints.{joint}] in a rig"
        raise UndeterminedError(error.quantity, f"its efforts are in A, and {error.reason}", record) from None


def _moving(
    read: Mapping[Path, tuple[Trace, Poses]], refused: Mapping[Path, BenchError], rig: Rig, joint: str
) -> tuple[dict[Path, tuple[Trace, Poses]], dict[str, str]]:
    """Recordings in which the joint moves, with the robot's poses, and why others are none; raises without one."""
    traces, reasons = dict[Path, tuple[Trace, Poses]](), dict(refused)
    for log, (recorded, poses) in read.items():
        try:
            trace = passed(recorded, rig).trace
            Rows.of(trace, rig)
            require_counted(joint, trace, rig)
            traces[log] = trace, poses
        except (InputError, UndeterminedError) as error:
            reasons[log] = _cause(error, joint, recorded, rig)
    if not traces:
        raise next(iter(reasons.values()))
    return traces, {log.name: str(error) for log, error in reasons.items()}


def _cause(error: BenchError, joint: str, recorded: Trace, rig: Rig) -> BenchError:
    """What is wrong with a log: that its effort is in another unit, if so; else the error."""
    try:
        require_counted(joint, recorded, rig)
    except InputError as cause:
        return cause
    except UndeterminedError:  # no more than the error
        return error
    return error


def _without_effects(
    joint: str, traces: Sequence[Trace], rig: Rig, refusal: UndeterminedError, left_out: Mapping[str, str]
) -> IdentifiedJoint:
    """Inertia and friction alone, as far as they are determined, of logs that do not decide on effects."""
    kind, refused, estimate = rig.axis_kind, {EFFECTS: refusal.reason, **_behind(rig)}, None
    try:
        estimate = identify(traces, rig)
    except RefusedEstimateError as error:
        estimate, refusal = error.estimate, error
    except UndeterminedError as error:
        refusal = error
    known = {} if estimate is None else estimate.parameters
    refused |= {name: error.reason for name, error in refused_masses(known, rig, ()).items()}
    for name in (*map(kind.parameter, (INERTIA, VISCOUS, COULOMB)), ARMATURE):
        if name not in known and name not in refused:
            refused[name] = refusal.reason
    return IdentifiedJoint(joint, rig, None, estimate, refused, refusal.record, left_out)
