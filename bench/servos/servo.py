"""What goal and measured position determine of a position-controlled servo, and what they cannot separate.

    J*dw/dt = clip(kp*(goal(t - d) - q) - kv*w, +-limit) - K_w*w - K_0*sgn(w) - load(t)

The motion scales with nothing: all torques, times any factor, move any inertia times the same factor alike. A log of
goal and position therefore determines kp/J, (kv + K_w)/J, K_0/J, limit/J and d. The scale comes from a known torque
(gravity on links of an MJCF, or on an eccentric mass of the rig) or a known inertia. kv and K_w act alike until
the controller reaches its limit: only then K_w brakes and kv does not.

Where the torque is recorded, its law gives kp and kv, and with them the scale (`bench.servos.law`). A drive with a
cascade is found by its law alone, and judged by its torque along the measured motion.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from bench.arrays import Array, rms
from bench.axis_kind import AxisKind
from bench.errors import InputError, UndeterminedError
from bench.gate.check import Check
from bench.gate.gate import gate, joined
from bench.names import percent, with_known_arguments
from bench.parameter import Parameter
from bench.plant.robot import Robot
from bench.presented import Presented
from bench.rig.rig import Rig
from bench.servos.drive import by_stated, drive_quantities
from bench.servos.fit import FORGETS, ServoFit, ServoLog, around, fitted, recorded
from bench.servos.joint import JointModel
from bench.servos.law import LATE, Law, law_of
from bench.servos.model import Stretches, simulated
from bench.servos.quantities import Quantities, quantities, warnings_of, with_law
from bench.trace.noise import resolution, white_noise
from bench.trace.read import read
from bench.trace.signals import KNOWN_MOMENTUM, KNOWN_SLOPE, KNOWN_TORQUE
from bench.trace.trace import Trace, join

#: A gain whose interval is wider than this share of it is not determined, nor is an inertia.
DETERMINED, SCALED = 0.5, 0.15
#: Half widths by which the weight of a link has to contradict a stated inertia.
CONTRADICTS = 2.0
#: Residual over noise floor up to which no effect is missing.
NOISE = 2.0
#: Radians that a loop turns between samples of the log, from which on the log is too slow for it.
SLOW = 1.2
#: Samples in the time in which that slowest loop that is not seen turns by SLOW, so that it is seen.
RESOLVED = 5.0
#: Distance over which the slope of a known torque is taken - rad.
ASIDE = 1e-3
#: A position error that stays above this share of its size, and of the range of the goal, does not distinguish a gain
#: from a limit.
ALIKE, AWAY = 0.5, 0.2
#: Position steps by which a signal has to move at least.
MOVES = 4.0


@dataclass(frozen=True)
class PositionGap:
    """RMS of measured less simulated position - rad (m) -, free-running from the goal, before and after the fit; of a
    drive, of measured torque less that of its law along the measured motion - N*m (N)."""

    before: float
    after: float


@dataclass(frozen=True)
class ServoMotion:
    """A recording with the servo's free-running simulation - s, rad (m) - (n,) each; of a drive, torques - N*m (N)."""

    time: Array
    goal: Array | None
    measured: Array
    before: Array
    after: Array


@dataclass(frozen=True, repr=False)
class Servo(Presented):
    """A position-controlled servo.

    Attributes:
        kind: rotary or linear.
        found: its parameters, and what only appears together.
        verdict: whether the residual is noise.
        noise_floor: of the measured position - rad (m) -, or of a drive's torque - N*m (N).
        gaps: of the log (`identify`), and of a holdout.
        before: what is simulated before the fit, in words.
        motion: of the first log.
        checks: of goal and position in the logs.
        warnings: what a user should know before relying on it.
        joint: name of the joint.
        values: of the simulated servo, parameters of `bench.servos.model.NULL`.
        law: of a drive with a cascade, which is not simulated.
    """

    kind: AxisKind
    found: Quantities
    verdict: Literal["nothing_missing", "explained", "unexplained_remainder"]
    noise_floor: float
    gaps: Mapping[str, PositionGap]
    before: str
    motion: ServoMotion
    checks: tuple[Check, ...]
    warnings: tuple[str, ...]
    joint: str
    values: Mapping[str, float]
    law: Law | None = None

    @property
    def compared(self) -> tuple[str, str]:
        """The signal that gaps are of, and its unit."""
        kind = self.kind
        return ("position", kind.length_unit) if self.law is None else (kind.effort, kind.effort_unit)

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """Those that are determined, by name."""
        return self.found.parameters


@with_known_arguments
def servo(
    log: str | Path | Trace | Sequence[str | Path | Trace],
    rig: Rig | None = None,
    mjcf: str | Path | None = None,
    joint: str | None = None,
    holdout: str | Path | Trace | None = None,
    stated: Mapping[str, float] | None = None,
    progress: Callable[[float], None] = lambda share: None,
    stand: bool = False,
) -> Servo:
    """Gains, dead time, limit and friction of a position-controlled servo from goal and measured position.

    Args:
        log: recordings of one servo, which hold `position_reference` and `position`; files, or traces in memory.
        rig: what is known of the axis: columns, an eccentric mass, inertias.
        mjcf, joint: the robot whose joint it is; its links give the scale of torques.
        holdout: another recording, not fitted.
        stated: positions of joints of the robot that stand and that the logs do not hold - rad (m).
        progress: called with the share done.
        stand: whether a floating base of the robot is fixed.

    Raises:
        InputError: no goal in the log, or files that do not fit together.
        UndeterminedError: a log that determines no gain, with what to record instead.
    """
    logs, model = [log] if isinstance(log, str | Path | Trace) else [*log], None
    if mjcf is not None:
        model = JointModel.of(Path(mjcf), Robot.of(Path(mjcf), joint, stand=stand), rig, stated or {}, stand)
    return by_logs(logs, rig, model, holdout, progress)


def by_logs(
    logs: Sequence[str | Path | Trace],
    rig: Rig | None,
    model: JointModel | None,
    holdout: str | Path | Trace | None = None,
    progress: Callable[[float], None] = lambda share: None,
) -> Servo:
    """The same with the model of the joint."""

    def opened(one: str | Path | Trace) -> Trace:
        if model is not None:
            return model.read(one)
        return one if isinstance(one, Trace) else read(one, None if rig is None else rig.trace)

    traces = [require_goal(opened(one)) for one in logs]
    other = None if holdout is None else require_goal(opened(holdout))
    trace = join(traces)
    effort = _effort(trace, rig, model)
    law = None if effort is None else law_of(trace, effort)
    if law is not None and law.reading.integral:
        return _drive(traces, law, rig, model, other)
    known = _known(trace, rig)
    of = _recorded(trace, known)
    fit, inertia = _scaled(of, rig, model, bool(known[0].any()), progress, law)
    _require_answered(of, fit)
    found = _result(traces, fit, inertia, rig, model, other)
    if law is not None:
        with_law(found.found, law, found.kind, 0.0 if model is None else model.link_inertia)
    elif effort is not None:
        note = "the recorded torque follows no law of goal and motion that is known: gains are from the motion alone"
        found = replace(found, warnings=(*found.warnings, note))
    return found


def require_goal(trace: Trace) -> Trace:
    """The trace; an error with the true reason where its goal and position cannot show a servo."""
    name = "position_reference"
    if "position" not in trace:
        raise InputError(
            trace.origin, "contains no position", 'allowed: a measured position, e.g. `position = "pos [rad]"`'
        )
    if name not in trace:
        found = f"contains no goal ({name}); its signals: {', '.join(trace.signals)}"
        allowed = (
            "allowed: a log with the position that is sent to the servo; map its column in the rig: "
            f'`{name} = "goal [rad]"`'
        )
        raise InputError(trace.origin, found, allowed)
    goal, position = trace[name], trace["position"]
    step = max(resolution(position), 1e-6 * float(np.ptp(position)))
    if np.ptp(goal) <= MOVES * max(step, 1e-9):
        raise UndeterminedError(
            "gains of the servo", "the goal never moves", "steps and waves of the goal, 10 s or more"
        )
    if np.ptp(position) <= MOVES * max(resolution(position), 1e-9):
        reason = "the goal moves but the position does not"
        raise UndeterminedError("gains of the servo", reason, "the same with the servo's torque switched on")
    if np.max(np.abs(goal - position)) <= max(step, 1e-6 * float(np.ptp(goal))):
        reason = "goal and measured position are equal in every sample"
        record = "the goal that is sent to the servo, not its position or a goal that the controller has corrected"
        raise UndeterminedError("gains of the servo", reason, record)
    near, far = np.quantile(np.abs(goal - position), (0.1, 0.9))
    if near > max(ALIKE * far, AWAY * float(np.ptp(goal))):
        reason = "the servo stays far from its goal, at its limit or nearly so, and a soft servo would move alike"
        raise UndeterminedError("gains of the servo", reason, "smaller and slower motions that the servo follows")
    return trace


def _effort(trace: Trace, rig: Rig | None, model: JointModel | None) -> Array | None:
    """The recorded torque at the position that the trace has - N*m (N) - (n,); None without one in this unit."""
    kind, own = trace.axis_kind, rig if model is None else model.rig
    if not {kind.effort, "current"} & set(trace.signals):
        return None
    if own is None:
        return trace.signals.get(kind.effort)
    effort, unit = own.effort(trace)
    return effort * (1.0 if model is None else own.gear_ratio) if unit == kind.effort_unit else None


def _known(trace: Trace, rig: Rig | None) -> tuple[Array, Array]:
    """Torque known to act against the motion - N*m (N) - and its slope over position - N*m/rad (N/m) - (n,).

    Of a robot's links, or of an eccentric mass.
    """
    load, position = None if rig is None else rig.load, trace["position"]
    if KNOWN_TORQUE in trace:
        rate = np.zeros(len(trace))
        for part in trace.segments:
            rate[part] = np.gradient(trace[KNOWN_MOMENTUM][part], trace.sample_period)
        return trace[KNOWN_TORQUE] + rate, trace[KNOWN_SLOPE]
    if load is not None and load.eccentric_mass is not None:
        ahead, behind = (load.gravity_torque(position + side * ASIDE) for side in (1.0, -1.0))
        return load.gravity_torque(position), (ahead - behind) / (2.0 * ASIDE)
    return np.zeros(len(trace)), np.zeros(len(trace))


def _recorded(trace: Trace, known: tuple[Array, Array]) -> ServoLog:
    return recorded(trace.sample_period, trace["position_reference"], trace["position"], known, trace.segments)


def _scaled(
    of: ServoLog,
    rig: Rig | None,
    model: JointModel | None,
    known: bool,
    progress: Callable[[float], None],
    law: Law | None,
) -> tuple[ServoFit, Callable[[Mapping[str, float]], float] | None]:
    """The fit, and how its values give the inertia - kg*m**2 (kg); None where nothing gives the scale of torques.

    A joint without armature in its MJCF is one whose motor and gear nobody stated, and weight may contradict what is.
    """
    if law is not None:
        return fitted(of, {}, progress), lambda values: law.stiffness / values["stiffness"]
    fit, stated = None, rig.stated_inertia if rig is not None else None
    if model is not None:
        stated = model.inertia if model.armature else None
    if known:
        fit = fitted(of, {}, progress)
        scale = fit.parameter(lambda values: values["mobility"], "")
        if scale.value > 0.0 and scale.half_width < SCALED * scale.value:
            return fit, lambda values: 1.0 / values["mobility"]
        if stated is not None and abs(1.0 / stated - scale.value) > CONTRADICTS * scale.half_width:
            stated = None
    if stated is None:
        return (fit if fit is not None else fitted(of, {}, progress)), None
    return fitted(of, {"mobility": 1.0 / stated} if known else {}, progress), lambda values: stated


def _require_answered(of: ServoLog, fit: ServoFit) -> None:
    """UndeterminedError where the log does not determine the stiffness, for the reason that is seen."""
    gain = fit.parameter(lambda values: values["stiffness"], "")
    rate, period = float(np.sqrt(fit.values["stiffness"])), of.stretches.period
    what = "gains of the servo"
    wide = gain.half_width > DETERMINED * gain.value
    if wide and "limit" in fit.names and _limited_share(of, fit) > 0.5:
        reason = f"the controller is at its limit for {percent(_limited_share(of, fit))} of the log"
        raise UndeterminedError(what, reason, "motions with smaller steps, so that the servo follows without its limit")
    if wide and rate * period > SLOW:
        reason = f"the servo follows within a sample of the log ({period * 1e3:.3g} ms)"
        # how far within is not known: the least that the loop can be asks for this rate
        raise UndeterminedError(what, reason, f"goal and position at {RESOLVED / period:.0f} Hz or more")
    if wide:
        reason = f"the log determines kp/J only to {100 * gain.half_width / gain.value:.0f} %"
        raise UndeterminedError(
            what, reason, "quick steps of the goal, several times larger than a step of the encoder"
        )


def refuse_unresolved(found: Quantities, period: float) -> None:
    """Take out a dead time that is within a sample of the log, and not known."""
    late = found.parameters["dead_time"]
    if late.half_width > DETERMINED * period and late.ci95[0] <= 0.0:
        del found.parameters["dead_time"]
        found.refused["dead_time"] = (
            f"the log, every {period * 1e3:.3g} ms, is too slow for it: it is between 0 and {late.ci95[1] * 1e3:.2g} ms"
        )
        found.advice.append(
            f"dead_time: goal and position at {np.ceil(4.0 / late.ci95[1] / 10.0) * 10.0:.0f} Hz or more."
        )


def _limited_share(of: ServoLog, fit: ServoFit) -> float:
    """Share of the samples in which a controller with the fitted gains requests its limit or more."""
    position = of.compared - fit.residual
    samples = of.stretches.samples()[:, of.skipped :]
    late = np.clip(samples - round(fit.values["dead_time"] / of.stretches.period), 0, None)
    speed = np.gradient(position, of.stretches.period, axis=1)
    demand = fit.values["stiffness"] * (of.stretches.goal[late] - position) - fit.values["drive_damping"] * speed
    return float(np.mean(np.abs(demand) >= fit.values["limit"]))


def free_run(values: Mapping[str, float], trace: Trace, known: tuple[Array, Array]) -> Array:
    """Position - rad (m) - (n,) of a servo with these values, from the beginning of each stretch without a hole."""
    found = np.empty(len(trace))
    position, period = trace["position"], trace.sample_period
    for part in trace.segments:
        first = np.array([part.start])
        speed = (position[first + min(2, part.stop - part.start - 1)] - position[first]) / (2.0 * period)
        goal, length = trace["position_reference"], part.stop - part.start
        start = Stretches(period, first, length, goal, *around(known, position), position[first], speed, 1).resolving(
            values["stiffness"]
        )
        found[part] = simulated({name: np.array([value]) for name, value in values.items()}, start)[0][0, 0]
    return found


def _gap(
    trace: Trace, fit: ServoFit, rig: Rig | None, first: Mapping[str, float] | None
) -> tuple[PositionGap, ServoMotion]:
    """How far free-running simulations are from a recording, before and after the fit.

    The speed at the beginning of a simulation is not known well: what the loop forgets is not counted.
    """
    known, goal, measured = _known(trace, rig), trace["position_reference"], trace["position"]
    before = goal if first is None else free_run(first, trace, known)
    after = free_run(fit.values, trace, known)
    counted = np.ones(len(trace), dtype=bool)
    for part in trace.segments:
        counted[part.start : part.start + round(FORGETS / trace.sample_period)] = False
    counted = counted if counted.any() else ~counted
    motion = ServoMotion(trace.time, goal, measured, before, after)
    return PositionGap(rms((measured - before)[counted]), rms((measured - after)[counted])), motion


def _drive(
    traces: Sequence[Trace], law: Law, rig: Rig | None, model: JointModel | None, holdout: Trace | None
) -> Servo:
    """A drive with a cascade, by the law that its torque follows."""
    kind, stated = traces[0].axis_kind, None if rig is None else rig.drive
    first = None if stated is None else {**by_stated(stated), LATE: law.values[LATE]}

    def motion(trace: Trace) -> ServoMotion:
        effort = _effort(trace, rig, model)
        assert effort is not None
        time, (measured, after) = law.torque(trace, effort)
        before = np.zeros_like(after) if first is None else law.torque(trace, effort, first)[1][1]
        return ServoMotion(time, None, measured, before, after)

    motions = {"identify": motion(join(traces)), **({} if holdout is None else {"holdout": motion(holdout)})}
    noise = law.residual <= NOISE * law.floor
    above = f"the residual is {law.residual / law.floor:.2g} times the noise: the drive's law has more than a cascade"
    return Servo(
        kind=kind,
        found=drive_quantities(law, kind, stated),
        verdict="nothing_missing" if noise else "unexplained_remainder",
        noise_floor=law.floor,
        gaps={
            k: PositionGap(rms(one.measured - one.before), rms(one.measured - one.after)) for k, one in motions.items()
        },
        before="no torque" if stated is None else "the rig's [drive]",
        motion=motions["identify"],
        checks=_checks(traces),
        warnings=(*(note for trace in traces for note in trace.notes), *([] if noise else [above])),
        joint="axis" if model is None else model.name,
        values={},
        law=law,
    )


def _checks(traces: Sequence[Trace]) -> tuple[Check, ...]:
    """Of goal and position."""
    used = ({name: trace[name] for name in ("position", "position_reference")} for trace in traces)
    return joined([gate(replace(trace, signals=each)).checks for trace, each in zip(traces, used, strict=True)])


def _result(
    traces: Sequence[Trace],
    fit: ServoFit,
    inertia: Callable[[Mapping[str, float]], float] | None,
    rig: Rig | None,
    model: JointModel | None,
    holdout: Trace | None,
) -> Servo:
    """All that follows from a fit."""
    first = model.before if model is not None else None
    pairs = [_gap(one, fit, rig, first) for one in traces]
    gaps = {
        "identify": PositionGap(
            *(float(np.sqrt(np.mean([getattr(gap, side) ** 2 for gap, _ in pairs]))) for side in ("before", "after"))
        )
    }
    if holdout is not None:
        gaps["holdout"] = _gap(holdout, fit, rig, first)[0]
    kind = traces[0].axis_kind
    positions = [one["position"][part] for one in traces for part in one.segments]
    floor = max(resolution(np.concatenate(positions)) / np.sqrt(12.0), white_noise(*positions))
    noise = fit.error <= NOISE * floor
    found = quantities(fit, inertia, kind, model)
    refuse_unresolved(found, traces[0].sample_period)
    notes = [note for trace in traces for note in trace.notes]
    return Servo(
        kind=kind,
        found=found,
        verdict="unexplained_remainder" if not noise else "explained" if found.effects else "nothing_missing",
        noise_floor=float(floor),
        gaps=gaps,
        before="the MJCF's actuator" if first is not None else "a servo that is always at its goal",
        motion=pairs[0][1],
        checks=_checks(traces),
        warnings=(*notes, *warnings_of(fit, floor, noise, traces[0].sample_period)),
        joint="axis" if model is None else model.name,
        values=dict(fit.values),
    )
