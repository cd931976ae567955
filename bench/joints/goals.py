"""A robot's joints by logs of goals and positions: each with the torque of its controller, then the delay of all.

A joint of unknown gains is fitted as a servo, whose gains are among what is found.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from bench.axis_kind import COULOMB, KINDS, MISALIGNMENT, OFFSET, VISCOUS, AxisKind
from bench.diagnosis.diagnosis import Diagnosis
from bench.errors import BenchError, InputError, UndeterminedError
from bench.export.mjcf import PositionDrive
from bench.fit.estimate import Estimate
from bench.joints.identified import EFFECTS, Goals, IdentifiedJoint, JointLogs, diagnosed
from bench.names import words
from bench.parameter import Parameter
from bench.plant.model_file import StoredModel
from bench.plant.robot import is_commanded, joint_rig, read_commanded
from bench.rig.rig import Load, Rig
from bench.servos.breakaway import static_friction
from bench.servos.commanded import Delay, Gains, balance, shared, wrong_scale
from bench.servos.joint import JointModel, gains_of
from bench.servos.servo import Servo, by_logs, require_goal
from bench.trace.trace import join

#: Parameters of the command: no effect on the joint changes them, and they may be negative.
COMMAND = ("dead_time", "joint_bias")
#: Gains of joints: one for all, or of each by its name.
GivenGain = float | Mapping[str, float] | None
#: Parameters of a servo that a position actuator does not have.
LACKING = ("speed_limit", *(kind.parameter(OFFSET) for kind in KINDS))


def with_gains(work: Sequence[JointLogs], kp: GivenGain, kd: GivenGain) -> list[JointLogs]:
    """The tasks of joints, each with its gains where the logs hold goals and no efforts; else as they are.

    Gains that are not given are those of the MJCF's position actuators. InputError where gains are given and the logs
    hold efforts, or kd of a joint without kp.
    """
    first = next((asked for asked in work if _without_effort(asked)), None)
    if first is None:
        if work and (kp is not None or kd is not None):
            allowed = "allowed: without it; or delete the columns of the effort, so that the gains are used"
            raise InputError("--kp", f"found with {work[0].logs[0].name}, which has efforts, or no goals", allowed)
        return [*work]
    known = _gains(work, kp, kd)
    return [replace(asked, goals=True, gains=known.get(asked.joint)) for asked in work]


def _without_effort(asked: JointLogs) -> bool:
    """Whether the first log has goals and no efforts; what is wrong with it is reported where it is identified."""
    try:
        robot = asked.robot()
        return is_commanded(asked.logs[0], joint_rig(asked.rig, robot), robot)
    except BenchError:
        return False


def _gains(work: Sequence[JointLogs], kp: GivenGain, kd: GivenGain) -> dict[str, Gains]:
    """Gains of joints by their names, those that are given first."""
    found, joints = gains_of(work[0].mjcf, work[0].stand), [asked.joint for asked in work]
    kps, kds = (
        {} if one is None else one if isinstance(one, Mapping) else dict.fromkeys(joints, one) for one in (kp, kd)
    )
    found |= {joint: Gains(one, found[joint].kd if joint in found else 0.0) for joint, one in kps.items()}
    for joint, one in kds.items():
        if joint not in found:
            raise InputError(f"--kd of '{joint}'", "found no --kp of it", "allowed: both, as --kp 40 --kd 1")
        found[joint] = replace(found[joint], kd=one)
    return found


def by_goals(asked: JointLogs) -> IdentifiedJoint:
    """The joint by its goals and positions; what is wrong with the logs, or what they do not determine, is in it.

    Its parameters are those of a delay of its own until `with_one_delay`.
    """
    try:
        if asked.gains is None:
            return _by_servo(asked)
        robot = asked.robot()
        rig = joint_rig(asked.rig, robot)
        logs = [*asked.logs, *([] if asked.holdout is None else [asked.holdout])]
        read = {log: read_commanded(log, rig, asked.robot_of(log), asked.stated) for log in logs}
        rig = _without_gear(rig)
        trace = join([require_goal(read[log][0]) for log in asked.logs])
        found = balance(trace, rig, replace(asked.gains, limit=robot.effort_limit or math.inf))
        driven = {log: (found.with_effort(trace), poses) for log, (trace, poses) in read.items()}
        unseen = {log: one for log, one in driven.items() if log not in asked.logs}
        fitted = {log: one for log, one in driven.items() if log in asked.logs}
        one = diagnosed(asked, rig, (fitted, {}), lambda: (unseen, {}))
    except UndeterminedError as error:
        return IdentifiedJoint(asked.joint, refused={EFFECTS: error.reason}, record=error.record)
    except BenchError as error:
        return IdentifiedJoint(asked.joint, failed=str(error))
    try:
        static, seldom = static_friction(found), ("", "")
    except UndeterminedError as error:
        static, seldom = None, (error.reason, error.record)
    return replace(one, goals=Goals(found.found, robot.inertia, static, seldom, wrong_scale(found)))


def _by_servo(asked: JointLogs) -> IdentifiedJoint:
    """The joint by a fit of its servo; BenchError as `bench.servos.servo.by_logs`."""
    if asked.mjcfs:
        found = "found goals and no efforts, several MJCF files, and a controller whose gains are not known"
        allowed = f"allowed: --kp {asked.joint}=40 --kd {asked.joint}=1 with yours, or one MJCF"
        raise InputError(f"{asked.mjcf}: joint '{asked.joint}'", found, allowed)
    model = JointModel.of(asked.mjcf, asked.robot(), asked.rig, asked.stated, asked.stand)
    found = by_logs(asked.logs, None, model, asked.holdout)
    refused = dict(found.found.refused)
    if "kp" not in found.parameters:
        refused |= {name: f"only {name} is determined: {value}" for name, value in found.found.inseparable.items()}
    return IdentifiedJoint(asked.joint, _without_gear(model.rig), servo=found, refused=refused)


def _without_gear(rig: Rig) -> Rig:
    """The rig of a joint whose signals are all on the joint's side."""
    return rig.model_copy(update={"load": (rig.load or Load()).model_copy(update={"gear_ratio": 1.0})})


def with_one_delay(joints: Mapping[str, IdentifiedJoint]) -> dict[str, IdentifiedJoint]:
    """Joints with the parameters of their goals, all of one delay unless those of their own clearly differ."""
    delay = shared([one.goals.found.delay for one in joints.values() if one.goals is not None])
    return {name: one if one.goals is None else _at(one, one.goals, delay) for name, one in joints.items()}


def _at(one: IdentifiedJoint, goals: Goals, delay: Delay | None) -> IdentifiedJoint:
    """A joint with the parameters of its goals; with effects, only with those on which they have no influence."""
    found, kind = goals.found if delay is None else goals.found.at(delay), goals.found.kind
    own, refused, record = found.parameters(goals.link_inertia), dict(one.refused), one.record
    static = f"static_friction_{kind.effort}"
    if one.diagnosis is not None and one.diagnosis.effects:
        own = {name: own[name] for name in COMMAND}
    elif goals.static is not None:
        own[static] = goals.static.at(goals.found, found)
    else:
        refused[static], record = goals.seldom[0], record or goals.seldom[1]
    refused = {name: why for name, why in refused.items() if name not in own}
    for name, value in [*own.items()]:
        if name not in COMMAND and value.ci95[1] < 0.0:
            refused[name] = f"it would be {value}: the gains, or the links of the MJCF, are another robot's"
            del own[name]
    replaced = tuple(name for name in own if name not in COMMAND)

    def changed(part: Diagnosis | Estimate) -> dict[str, Any]:
        dropped = kind.parameter(MISALIGNMENT), *refused
        parameters = {name: value for name, value in part.parameters.items() if name not in dropped} | own
        warnings = [text for text in part.warnings if not text.startswith(replaced)]
        warnings += [goals.doubt] if goals.doubt else []
        return {"parameters": parameters, "warnings": type(part.warnings)(warnings)}

    diagnosis = one.diagnosis and replace(one.diagnosis, **changed(one.diagnosis))
    estimate = one.estimate and replace(one.estimate, **changed(one.estimate))
    if diagnosis is not None and diagnosis.model is not None:
        diagnosis = replace(diagnosis, model=_with_values(diagnosis.model, own, kind))
    return replace(one, diagnosis=diagnosis, estimate=estimate, refused=refused, record=record)


def _with_values(stored: StoredModel, own: Mapping[str, Parameter], kind: AxisKind) -> StoredModel:
    """A model with those of inertia and friction that the goals show."""
    names = {"inertia": kind.inertia, "viscous_friction_coefficient": kind.parameter(VISCOUS)}
    names["coulomb_friction"] = kind.parameter(COULOMB)
    values = {key: max(own[name].value, 0.0) for key, name in names.items() if name in own}
    axis = replace(stored.model, parameters=replace(stored.model.parameters, **values))
    return replace(stored, model=axis, misalignment=0.0)


def drive_of(joint: IdentifiedJoint) -> PositionDrive | None:
    """The position controller of a joint; None where it was not found by goals."""
    goals, known = joint.goals, joint.parameters
    if joint.servo is not None:
        return _fitted_drive(joint.servo)
    if goals is None or "dead_time" not in known:
        return None
    static = next((one for name, one in known.items() if name.startswith("static_friction")), None)
    lacking = [f"joint bias of {known['joint_bias']}: add it to the goals"]
    lacking += [] if static is None else [f"static friction of {static}"]
    gains = goals.found.gains
    return PositionDrive(gains.kp, gains.kd, max(known["dead_time"].value, 0.0), gains.limit, tuple(lacking))


def _fitted_drive(servo: Servo) -> PositionDrive | None:
    """The position controller that was fitted; None where torques have no scale."""
    of = servo.found
    if not of.actuator:
        return None
    lacking = [f"{words(name)} of {value}" for name, value in of.parameters.items() if name in LACKING]
    lacking += [
        f"{words(name)} with {words(quantity)} {value}"
        for name, values in of.effects.items()
        for quantity, value in values.items()
    ]
    kp, kv, delay = (of.actuator[name] for name in ("kp", "kv", "delay"))
    return PositionDrive(kp, kv, delay, of.actuator.get("forcerange", math.inf), tuple(lacking))
