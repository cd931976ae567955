"""Known effects put into a recording: the motion stays as it was, what drives it or what is read of it changes.

Had the axis had the effect and moved as it did, its drive would have had to give more torque, so an effect on the axis
adds to the recorded effort; one of a sensor changes the signal that it reads. The formulas are those of the independent
axis; the speed and acceleration that they ask for come from a local cubic through the raw samples, so that nothing is
shared with identification of the recording. What the recording has of its own stays in it: the truth of the
effect is known, on the noise of a real machine.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter, savgol_filter

from bench.arrays import Array, rms
from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.fit.fit import fit
from bench.fit.hypothesis import plain
from bench.fit.rows import Rows
from bench.rig.rig import Rig
from bench.trace.motion import Conditioning
from bench.trace.trace import Trace
from bench.validation.independent.effects import KINDS, Effect
from bench.validation.independent.rig import Axis
from bench.validation.plan import HIDEABLE

#: Width of the local cubic: samples at least, and time - s. Of a motion of 20 Hz, sampled at 1 kHz, it keeps 99 %.
SAMPLES, WIDTH = 7, 12e-3
#: Speed, over the noise of the cubic's speed, above which its sign is sure: noise alone passes it in 1 of 16,000.
SURE = 4.0
#: Hooks through which an effect acts on the motion itself.
MOVING = ("driven_current", "remember")
#: Hooks through which the reported effort is another one, whatever acts behind it.
REPORTED = ("acting_current", "recorded_current", "true_current")
#: Steps in a swing of a load on its contact: its frequency is right to 0.7 %.
STEPS = 16
#: Steps in which what drives the axis is found, and the share of it that it is found to.
TRIES, EXACT = 200, 1e-9
#: Severities between which an effect of a wanted size is sought, the ratio at which the search ends, and the one by
#: which the size may fall short where physics ends before it.
SEVERITIES, CLOSE, SHORT = (1e-4, 3.0), 1.03, 1.1


@dataclass(frozen=True)
class Host:
    """A recording that effects are put into.

    Attributes:
        trace: with a position, or a velocity.
        rig: of its axis, which states what drives it.
        axis: J, K_w, K_0, torque constant, peak current and the rest that effects refer to.
        load: torque of what a gear carries, as far as the recording has it - N*m (N) (m,); None if not at all.
        moved: the recording as the axis moved, where its sensors are known to err; None if they are not.
        lag: by which torque and motion are known to follow the reported effort - s.
    """

    trace: Trace
    rig: Rig
    axis: Axis
    load: Array | None = None
    moved: Trace | None = None
    lag: float = 0.0


@dataclass(frozen=True)
class StandIn:
    """All samples of a recording, in the place of the rows of a plant that the hooks of effects ask - (m,) each.

    Attributes:
        host: the recording.
        time: from the recording's start - s.
        position, velocity, acceleration: of the axis - rad, rad/s, rad/s**2.
        direction: sign of the speed, 0 where the axis may rest: friction at rest takes what it is given.
        motor_torque, acting_current, peak_current: that move it, and its most - N*m (N), A, A.
    """

    host: Host
    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    direction: Array
    motor_torque: Array
    acting_current: Array
    peak_current: Array

    def __getattr__(self, name: str) -> Array:
        """A constant of the axis."""
        return np.full(self.time.size, getattr(self.host.axis, name))

    @property
    def load_torque(self) -> Array:
        """Of what a gear carries - N*m (N); InputError where it is not known."""
        if self.host.load is None:
            raise InputError(
                "load torque", "found none in the recording", "allowed: an axis that is known to carry one"
            )
        return self.host.load

    def driven_by(self, torque: Array) -> StandIn:
        """The same motion under another motor torque - N*m (N) (m,)."""
        return replace(self, motor_torque=torque, acting_current=torque / self.host.axis.torque_constant)


def stand_in(host: Host, trace: Trace | None = None) -> StandIn:
    """The motion of a recording, or of a changed one, by a local cubic through its samples."""
    trace = trace or host.moved or host.trace
    position, velocity, acceleration, direction = np.concatenate([_motion(trace, p) for p in trace.segments], axis=1)
    effort, time = host.rig.effort(trace)[0], trace.time - trace.time[0]
    current, peak = effort / host.axis.torque_constant, np.full(len(trace), host.axis.peak_current)
    return StandIn(host, time, position, velocity, acceleration, direction, effort, current, peak)


def _cubic(values: Array, period: float, order: int = 0) -> Array:
    """The local cubic through even samples, or a derivative of it - their unit over s**order (m,)."""
    width = min(max(SAMPLES, int(WIDTH / period)) | 1, (values.size - 1) | 1)
    return np.asarray(savgol_filter(values, width, min(3, width - 1), order, period))


def _motion(trace: Trace, part: slice) -> Array:
    """Position, speed, acceleration and direction in one stretch without a hole (4, m)."""
    period = trace.sample_period
    if "position" in trace:
        position, velocity, acceleration = (_cubic(trace["position"][part], period, order) for order in range(3))
    else:
        velocity, acceleration = (_cubic(trace["velocity"][part], period, order) for order in range(2))
        position = np.concatenate([[0.0], np.cumsum(0.5 * period * (velocity[1:] + velocity[:-1]))])
    noise = float(np.median(np.abs(velocity - _cubic(velocity, period)))) / 0.6745
    least = max(SURE * noise, 1e-9 * float(np.abs(velocity).max()))
    return np.stack([position, velocity, acceleration, np.sign(velocity) * (np.abs(velocity) > least)])


def acts(effect: Effect | type[Effect], *hooks: str) -> list[str]:
    """Those of these hooks through which an effect acts."""
    return [hook for hook in hooks if hasattr(effect, hook)]


#: Names of the catalogue that can be put into a recording: those of the independent axis that leave the motion to it.
INJECTABLE = tuple(name for name in HIDEABLE if not acts(KINDS[name], *MOVING))


def injected(host: Host, effect: Effect) -> Trace:
    """The recording of the same motion, had the axis had an effect of the independent axis.

    Raises:
        InputError: an effect that acts on the motion itself, as a voltage limit, on a signal that is not recorded, or
            that is so strong that the axis cannot have moved as it did.
    """
    if unable := acts(effect, *MOVING):
        raise InputError(effect.name, f"acts by {', '.join(unable)}", "allowed: effects that do not change the motion")
    if acts(effect, "measured", "filtered"):
        return _read_otherwise(host.trace, effect)
    seen = stand_in(host)
    current = _reported(effect, seen.driven_by(_needed(effect, seen)))
    more = current * seen.torque_constant - seen.motor_torque
    if host.lag and not acts(effect, *REPORTED):
        more = np.concatenate([_ahead(more[part], host.trace.sample_period, host.lag) for part in host.trace.segments])
    return driven(host, effect.name, seen.motor_torque + more)


def _needed(effect: Effect, seen: StandIn) -> Array:
    """Motor torque that the motion takes with the effect - N*m (N) (m,)."""
    torque = seen.motor_torque
    if acts(effect, "resisting_torque"):
        torque = torque + effect.resisting_torque(seen)
    if acts(effect, "added_inertia"):
        torque = torque + effect.added_inertia(seen) * seen.acceleration
    if acts(effect, "bristle_torque"):
        torque = torque + np.abs(seen.direction) * _bristles(effect, seen) - seen.coulomb * seen.direction
    if acts(effect, "transmitted_torque"):
        torque = torque - _behind_coupling(effect, seen)
    if acts(effect, "friction_excess", "friction_difference", "friction_factor"):  # of the torque that overcomes it
        return _solved(lambda at: at - _friction(effect, seen.driven_by(at)), torque, effect.name)
    return torque


def _friction(effect: Effect, seen: StandIn) -> Array:
    """Dry friction beyond K_0, against the motion - N*m (N) (m,)."""
    level = seen.coulomb
    if acts(effect, "friction_excess"):
        level = level + effect.friction_excess(seen)
    if acts(effect, "friction_difference"):
        level = level + 0.5 * seen.direction * effect.friction_difference(seen)
    if acts(effect, "friction_factor"):
        level = level * effect.friction_factor(seen)
    return (np.maximum(level, 0.0) - seen.coulomb) * seen.direction


def _bristles(effect: Effect, seen: StandIn) -> Array:
    """Torque of bristles that the motion bends, straight at the start of each stretch - N*m (N) (m,)."""
    level, bent = np.maximum(seen.coulomb, 1e-12), np.zeros_like(seen.position)
    period = seen.host.trace.sample_period
    for part in seen.host.trace.segments:
        for k, speed in enumerate(np.diff(seen.position[part]) / period, part.start):
            bent[k + 1] = effect.bend(speed, level[k], bent[k], period)
    return effect.bristle_torque(seen, level, bent)


def _behind_coupling(effect: Effect, seen: StandIn) -> Array:
    """Torque that a load behind a coupling does not ask of the motor that a rigid one would - N*m (N) (m,).

    With the motor's motion given, twist obeys J_l*twist'' + transmitted(twist, twist') = J_l*alpha; the motor carries
    what is transmitted in the place of J_l*alpha.
    """
    axis, period = seen.host.axis, seen.host.trace.sample_period
    load = axis.inertia - axis.rotor_inertia
    far = np.array(1e6)  # in contact, whatever the gap: there what is transmitted rises by the stiffness
    stiffness = effect.transmitted_torque(seen, 2.0 * far, 0.0 * far) - effect.transmitted_torque(seen, far, 0.0 * far)
    count = math.ceil(STEPS * period * math.sqrt(float(stiffness) / float(far) / load) / (2.0 * math.pi))
    step, less = period / count, np.zeros_like(seen.position)
    for part in seen.host.trace.segments:
        twist = rate = np.zeros(())
        for k, alpha in enumerate(seen.acceleration[part], part.start):
            less[k] = load * alpha - effect.transmitted_torque(seen, twist, rate)
            for _ in range(count):
                rate = rate + step * (alpha - effect.transmitted_torque(seen, twist, rate) / load)
                twist = twist + step * rate
    return less


def _solved(function: Callable[[Array], Array], wanted: Array, what: str) -> Array:
    """Where a function that is nearly its argument is as wanted (m,); InputError where it is not near enough."""
    at, missing = wanted, wanted - function(wanted)
    scale = float(np.abs(wanted).max() + np.abs(missing).max())
    for _ in range(TRIES):
        most = float(np.abs(missing).max())
        if most <= EXACT * scale:
            return at
        if most > scale / EXACT:
            break
        at = at + missing
        missing = wanted - function(at)
    raise InputError(what, "found so strong that no torque moves the axis as it moved", "allowed: a weaker one")


def _reported(effect: Effect, seen: StandIn) -> Array:
    """Current that is recorded while one makes the torque that moves the axis - A (m,)."""
    current = seen.acting_current

    def delivered(at: Array) -> Array:
        """What one acts like; where the rig has no peak current, the largest that is recorded is it."""
        peak = np.maximum(seen.peak_current, np.abs(at).max())
        return at * effect.torque_factor(replace(seen, acting_current=at, peak_current=peak))

    if acts(effect, "torque_factor"):
        current = _solved(delivered, current, effect.name)
    if acts(effect, "true_current"):
        current = _solved(lambda at: effect.true_current(seen, at), current, effect.name)
    for hook, lagging in (("acting_current", _ahead), ("recorded_current", behind)):
        if acts(effect, hook):
            period, constant = seen.host.trace.sample_period, effect.time_constant
            current = np.concatenate([lagging(current[part], period, constant) for part in seen.host.trace.segments])
    return current


def _ahead(values: Array, period: float, constant: float) -> Array:
    """What the values are behind: T*dx/dt + x, the slope by the local cubic - any unit (m,)."""
    return values + constant * _cubic(values, period, 1)


def behind(values: Array, period: float, constant: float) -> Array:
    """Values behind T*dy/dt = x - y, settled at the first; exact where x is linear between samples - any unit (m,).

    Args:
        values: x.
        period: between them - s.
        constant: T - s.
    """
    kept = math.exp(-period / constant)
    lag = lfilter([constant / period * (1.0 - kept)], [1.0, -kept], np.diff(values, prepend=values[0]))
    return values - lag


def _read_otherwise(trace: Trace, effect: Effect) -> Trace:
    """The recording with another reading of its sensor of position and speed."""
    if acts(effect, "filtered"):
        velocity = trace["velocity"]
        late = [behind(velocity[part], trace.sample_period, effect.time_constant) for part in trace.segments]
        return trace.with_signals({"velocity": np.concatenate(late)}, {})
    velocity = trace["velocity"] if "velocity" in trace else np.zeros(len(trace))
    read = zip(("position", "velocity"), effect.measured(trace["position"], velocity), strict=True)
    return trace.with_signals({name: values for name, values in read if name in trace}, {})


def driven(host: Host, what: str, effort: Array) -> Trace:
    """The recording with another effort, in its signal."""
    trace, rig = host.trace, host.rig
    name = next(each for each in (rig.axis_kind.effort, "current", "voltage") if each in trace)

    def effort_of(values: Array) -> Array:
        return rig.effort(trace.with_signals({name: values}, {}))[0]

    step = np.full(len(trace), 1e-6 * float(np.abs(trace[name]).max() or 1.0))
    gain = float(np.median((effort_of(step) - effort_of(0.0 * step)) / step))
    return trace.with_signals({name: _solved(lambda at: effort_of(at / gain), effort, what) / gain}, {})


def disturbance(host: Host, made: Trace, seen_as: Conditioning | None = None) -> tuple[float, float]:
    """How much torque a change of a recording makes, and how much of it remains after a fit without effects - N*m (N).

    RMS of M - J*alpha - K_w*omega - K_0*sgn(omega) in `made` less in the recording: by the axis' own values at all
    samples in motion; and after J, K_w, K_0 and the shift of torque against speed are fitted to each, at the rows of
    the balance and through its filter, as the residual of a diagnosis is measured. A change of the reported speed
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
    """Only the axis, as it was found to move under J, K_w, K_0 and its load: without the rest of a recording."""
    seen, axis = stand_in(host), host.axis
    torque = axis.inertia * seen.acceleration + axis.viscous * seen.velocity + axis.coulomb * seen.direction
    plain = driven(host, "the axis", torque + (0.0 if host.load is None else host.load))
    return replace(host, trace=plain, moved=None, lag=0.0)


def drawn(host: Host, kind: str, size: float, seed: int) -> Effect | None:
    """An effect of a kind with a wanted RMS beyond what J, K_w and K_0 take up, on the axis alone.

    An effect of torque scales the rest of a recording, too, which shows nothing of it; the filter is the one
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
