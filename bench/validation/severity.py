"""How large an effect is that is put into a recording, and one of a wanted size."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from bench.arrays import rms
from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.fit.fit import fit
from bench.fit.hypothesis import plain
from bench.fit.rows import Rows
from bench.trace.motion import Conditioning
from bench.trace.trace import Trace
from bench.validation.independent.effects import KINDS, Effect
from bench.validation.injection import Host, driven, injected, stand_in

#: Severities between which an effect of a wanted size is sought, the ratio at which the search ends, and the one by
#: which the size may fall short where physics ends before it. The last severity is four times the strongest of the
#: blind set: beyond it is no axis any more, as with warm-up of five times the friction.
SEVERITIES, CLOSE, SHORT = (1e-4, 3.0), 1.03, 1.1


def disturbance(host: Host, made: Trace, seen_as: Conditioning | None = None) -> tuple[float, float]:
    """How much torque a change of a recording makes, and how much of it a fit without effects leaves - N*m (N).

    RMS of M - J*alpha - K_w*omega - K_0*sgn(omega) in `made` less in the recording: by the axis' own values at all
    samples in motion; and after J, K_w, K_0 and the shift of torque against speed are fitted to each, at the rows of
    the balance and through its filter, as what a diagnosis leaves is measured. A change of the reported speed
    alone is judged by that speed, though a position be recorded.

    Args:
        host: the axis, with the recording.
        made: the changed recording.
        seen_as: filter and thresholds of the balance, if not those of the recording itself.
    """
    trace, axis = host.trace, host.axis
    changed = {name for name in trace.signals if not np.array_equal(trace[name], made[name])}
    if changed == {"velocity"} and "position" in trace:
        trace, made = trace.without("position"), made.without("position")
    before, after = stand_in(host, trace), stand_in(host, made)
    axes = np.stack([after.acceleration, after.velocity, after.direction])
    values = np.array([axis.inertia, axis.viscous, axis.coulomb])
    more = after.motor_torque - before.motor_torque
    more = more - values @ (axes - [before.acceleration, before.velocity, before.direction])
    rows = Rows.of(trace, host.rig, conditioning=seen_as)
    changed_rows = Rows.of(made, host.rig, conditioning=rows.conditioning)
    _, own, others = np.intersect1d(rows.samples(), changed_rows.samples(), return_indices=True)
    left = fit(changed_rows, plain(changed_rows)).left[others] - fit(rows, plain(rows)).left[own]
    return rms(more[before.direction != 0.0]), rms(left)


def modelled(host: Host) -> Host:
    """The axis alone, as it was found to move under J, K_w, K_0 and its load: what else a recording holds left out."""
    seen, axis = stand_in(host), host.axis
    torque = axis.inertia * seen.acceleration + axis.viscous * seen.velocity + axis.coulomb * seen.direction
    plain = driven(host, "the axis", torque + (0.0 if host.load is None else host.load))
    return replace(host, trace=plain, moved=None, lag=0.0)


def drawn(host: Host, kind: str, size: float, seed: int) -> Effect | None:
    """An effect of a kind that leaves a wanted RMS beyond what J, K_w and K_0 take up, on the axis alone.

    An effect made of torque scales what else a recording holds, too, which shows nothing of it; the filter is the one
    of the recording, as coherence of motion and torque, which it is chosen by, is greater on the axis alone.

    Args:
        host: that it is to be put into.
        kind: name of the effect.
        size: the second RMS of its `disturbance` - N*m (N).
        seed: of its other parameters.

    Returns:
        None if the axis cannot have it, or not of this size within its physical bounds.
    """
    if not KINDS[kind].possible(host.axis):
        return None
    bounds = {quantity.name: quantity for quantity in catalogue()[kind].quantities}
    duration, alone = float(host.trace.time[-1] - host.trace.time[0]), modelled(host)
    seen_as = Rows.of(host.trace, host.rig).conditioning

    def of(severity: float) -> Effect:
        return KINDS[kind].draw(host.axis, severity, np.random.default_rng(seed), duration)

    def reached(severity: float) -> float:
        effect = of(severity)
        values = effect.quantities(host.axis).items()
        if any(not bounds[name].lower <= value <= bounds[name].upper for name, value in values if name in bounds):
            return math.inf
        try:
            return disturbance(alone, injected(alone, effect), seen_as)[1]
        except InputError:  # the axis cannot have it so strong
            return math.inf

    (low, high), below = SEVERITIES, 0.0
    if not reached(high) > size:
        return None
    while high > CLOSE * low:
        middle = math.sqrt(low * high)
        now = reached(middle)
        low, high, below = (low, middle, below) if now > size else (middle, high, now)
    return of(low) if below > size / SHORT else None
