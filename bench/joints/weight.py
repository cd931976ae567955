"""What the known weight of the links shows of a joint's effort: its torque constant, and a payload that is another.

    I = (J*alpha + K_w*omega + f*sgn(omega))/kT + M_known/kT
    f = K_0 + mu*|M_known| + sum over l of a_l*exp(-(omega/w_l)**2)

I - current - A; M_known - torque of the links by the MJCF - N*m (N). Without a known torque kT cannot be distinguished
from inertia and friction. Its sign is the joint's: of a log that counts the current the other way it is negative. Where
logs have a payload each, an effort in N*m counts the known torque of all alike; one that differs has another payload
than its MJCF.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from bench.arrays import Array, rms
from bench.comparison.spread import ALARM, excess
from bench.effects.signals import Signals
from bench.errors import InputError, UndeterminedError
from bench.fit.hypothesis import BASE, lay_out, plain
from bench.fit.rows import Rows, effort_of, known_of
from bench.fit.solution import block_edges, equations, estimated
from bench.names import readable
from bench.parameter import Parameter
from bench.rig.rig import Rig
from bench.rig.values import Toleranced
from bench.trace.filter import Column
from bench.trace.trace import Trace

#: Speeds over which friction may fall, as shares of the usual one; columns that every joint has of its own.
SLOW = (0.1, 0.4)
OWN = len(BASE) + 1 + len(SLOW)
#: Least share of a column's power that the joint's own terms must leave.
LEAST = 0.01
#: By how much an effort may count the known torque: what `torque_scale` may be.
POSSIBLE = 0.2, 5.0
#: Share of the known torque by which logs may count it differently: masses are weighed and lengths measured as well.
WEIGHED = 0.01


def own_columns(rows: Rows) -> Array:
    """Columns of a joint's inertia and friction (m, OWN)."""
    return np.column_stack([lay_out(rows, plain(rows)).columns[:, : len(BASE)], rows.table(_frictions)])


def _frictions(signals: Signals) -> list[Column]:
    """Friction by transmitted torque, and by speeds that are a share of the usual one.

    No joint has been diagnosed yet: the part of its friction that is not a level would pass for weight. What is
    transmitted is what the links ask: where friction takes nearly all, the measured torque would explain itself.
    """
    speed = np.abs(signals.velocity)
    slow = (np.exp(-((speed / (share * rms(speed) + 1e-300)) ** 2)) for share in SLOW)
    return [[(signals.sign * shape, 0)] for shape in (np.abs(signals.carried), *slow)]


def needs_constant(rig: Rig, trace: Trace) -> bool:
    """Whether the effort of a joint is a current that no constant of its rig makes a torque."""
    return rig.motor.torque_per_ampere is None and rig.effort(trace)[1] == "A"


def with_constant(rig: Rig, constant: float) -> Rig:
    """The rig of a joint with a torque (force) constant - N*m/A (N/A)."""
    name = "torque_constant" if rig.axis_kind.turns else "force_constant"
    return rig.model_copy(update={"motor": rig.motor.model_copy(update={name: constant})})


def constant_of(traces: Sequence[Trace], rig: Rig) -> tuple[Rig, Parameter]:
    """The rig with the torque (force) constant of a joint by its logs, whose efforts are currents, and that constant.

    UndeterminedError where the known torque does not determine it.
    """
    shares = [one for trace in traces if (one := _counted(trace, with_constant(rig, 1.0))) is not None]
    values, errors, halves = (
        np.array([getattr(one, of) for one in shares]) for of in ("value", "std_error", "half_width")
    )
    weights = np.maximum(halves, 1e-150) ** -2.0
    weights = weights / weights.sum()
    share, error, half = float(weights @ values), *(float(np.linalg.norm(weights * each)) for each in (errors, halves))
    if abs(share) <= half or not shares:
        reason = "no known weight of links or payload moves clearly"
        raise UndeterminedError("torque constant", reason, "a motion that lifts links or a payload of known mass")
    value, error, half = 1.0 / share, error / share**2, half / share**2
    return with_constant(rig, Toleranced(value, half)), Parameter.around(value, f"{rig.effort_unit}/A", error, half)


def counted_differently(traces: Mapping[Path, Trace], rig: Rig) -> Iterator[str]:
    """A warning where logs count the known torque of their own MJCF differently, by log and share."""
    shares = {log: share for log, trace in traces.items() if (share := _counted(trace, rig)) is not None}
    values = [one.value for one in shares.values()]
    if len(values) > 1 and excess([[*shares.values()]]).chance < ALARM and np.ptp(values) > WEIGHED * max(values):
        counts = (f"{one.value:.3f} ± {one.half_width:.2g} in {readable(log.name)}" for log, one in shares.items())
        which = "check the payload in the MJCF of the one that differs"
        yield f"the known weight counts {', '.join(counts)} times: {which}"


def require_counted(joint: str, trace: Trace, rig: Rig) -> None:
    """InputError where the effort of a joint is surely not the one on it - N*m (N) -, by the weight of the links."""
    share, (least, most) = _counted(trace, rig), POSSIBLE
    if share is None or (share.ci95[1] > least and share.ci95[0] < most):
        return
    effort, notes = rig.axis_kind.effort, f"[joints.{joint}"
    times = f"{share.value:.3g} ± {share.half_width:.2g} times"
    found = f"its {effort} is {times} what the known weight of the links requires"
    allowed = (
        f"allowed: {least:g} to {most:g} times. On the motor's side of a gear: state `gear_ratio = 50` under {notes}] "
        "in a rig. In another unit, or a share: state what one of it is, "
        f'`{effort} = "COLUMN [0.15 {rig.effort_unit}]"` under {notes}.columns]. '
        "A command without gravity compensation: add that to it"
    )
    other = ". In the opposite direction: put a - in front of its column there" if share.ci95[1] < 0.0 else ""
    raise InputError(f"{trace.origin}: joint '{joint}'", found, allowed + other)


def _counted(trace: Trace, rig: Rig) -> Parameter | None:
    """By how much the effort of a joint has the known torque - its unit per N*m (N); None where that is none apart.

    Noise of the motion is taken out of the equations: that of the acceleration reduces the inertia, and the weight of a
    pendulum, which goes with it, would make it good.
    """
    rows = Rows.of(trace, rig)
    smooth, laid = rows.conditioning.filter, lay_out(rows, plain(rows))
    base, noise = slice(len(BASE)), np.zeros((OWN + 1, OWN + 1))
    noise[base, base] = own = laid.noise[base, base]
    noise[base, OWN] = noise[OWN, base] = rows.known_inertia * own[0]
    other = rows.conditioning.known_noise * smooth.noise_gain(1)
    noise[OWN, OWN] = rows.known_inertia**2 * own[0, 0] + other**2
    table = np.vstack([own_columns(rows).T, rows.kept(known_of).T, rows.kept(effort_of).T])
    every = equations(tuple(range(OWN + 1)), table, noise, block_edges(rows.time, smooth.width))
    if every.independent_shares([OWN])[0] < LEAST:
        return None
    theta, inverse = every.solved()
    covariance, reach = estimated(every.scores(theta), inverse, rows.conditioning.effort_noise**2 / smooth.stride)
    value, error = float(theta[OWN]), float(np.sqrt(max(covariance[OWN, OWN], 0.0)))
    return Parameter.around(value, "dimensionless", error, reach * error)
