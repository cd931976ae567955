"""The motion that best distinguishes two explanations: both models are simulated along every profile of the rig.

Two explanations remain if names are ambiguous, if an alternative has hardly more residual than the named effect, or if
motion in one direction does not separate dry friction from a constant torque. The criterion is the torque that one
model would miss on the other's recording,

    e = dM - J*d(dw)/dt - K_w*dw,

dM, dw - differences of reported torque and velocity under the same drive - through the filter of the diagnosis, less
what other values of J, K_w, K_0 and a shift in time would absorb, over the noise floor of the recording.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from bench.arrays import rms
from bench.diagnosis.add import Added
from bench.diagnosis.model import stored_model
from bench.diagnosis.recordings import Recordings
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect, Lag
from bench.effects.present import Present
from bench.effects.signals import Axis
from bench.errors import BenchError, InputError
from bench.fit.fit import fit
from bench.fit.rows import sign_reach
from bench.names import percent
from bench.plant.axis_model import AxisModel
from bench.plant.drive import Cascade, References
from bench.plant.plant import Plant
from bench.plant.profiles import PROFILES, MotionLimits, plan
from bench.plant.run import run
from bench.plant.sensing import reported_states
from bench.trace.filter import GaussianFilter
from bench.trace.motion import measured_velocity

#: Least duration of a recording - s: a shorter profile is repeated.
LONG_ENOUGH = 4.0
#: Ratio of residuals, with an alternative to with the named effect, below which both explanations remain.
NEARLY = 1.1
#: Least separation of an experiment, in noise floors.
TELLS = 3.0
#: Shortest tick of the simulated drive - s: profiles are only compared.
COARSEST_TICK = 0.5e-3
#: Share of the top speed below which the direction is uncertain, and least number of samples of certain direction.
CLEAR, LEAST = 0.01, 50
#: Names of two explanations, their models, and why both remain.
Alternatives = tuple[tuple[str, str], tuple[AxisModel, AxisModel], str]


@dataclass(frozen=True)
class NextExperiment:
    """A motion to record.

    Attributes:
        profile: of `bench simulate --profile`.
        speed, acceleration: highest of it - rad/s, rad/s**2 (m/s, m/s**2).
        duration: of one run - s.
        repetitions: of it, one after the other.
        tells_apart: the named effect and its alternative.
        separation: of the two, over the noise floor.
        reason: why it is needed.
        motion: with repetitions, at a coarse tick.
    """

    profile: str
    speed: float
    acceleration: float
    duration: float
    repetitions: int
    tells_apart: tuple[str, str]
    separation: float
    reason: str
    motion: References


def propose(added: Added) -> NextExperiment | None:
    """The experiment for the first two explanations that can be distinguished; None if only one remains."""
    recordings, stored = added.recordings, added.model
    if stored is None or recordings.rig.drive is None:
        return None
    width, floor = recordings.rows.conditioning.filter.width, added.extension.fitted.floor
    for names, models, reason in alternatives(added, stored.model):
        try:
            found = [
                (separation(recordings, models, references, width) / floor, name, references)
                for name, references in motions(recordings, stored.model)
            ]
        except BenchError:
            continue
        best, name, references = max(found, key=lambda tried: tried[0])
        if best > TELLS:
            speed, acceleration = (float(np.abs(v).max()) for v in (references.velocity, references.acceleration))
            duration = float(references.time[-1])
            again = int(np.ceil(LONG_ENOUGH / duration))
            motion = references.repeated(again)
            return NextExperiment(name, speed, acceleration, duration, again, names, best, reason, motion)
    return None


def alternatives(added: Added, model: AxisModel) -> Iterator[Alternatives]:
    """Other explanations that remain, as models."""
    for effect in added.effects:
        if not _of_motion(effect.effect):
            continue
        for other in effect.ambiguous_with:
            if _of_motion(catalogue()[other]):
                kept = [present for present in model.effects if present.effect is not effect.effect]
                models = model, model.with_effects([*kept, Present.of(other, effect.values)])
                yield (effect.name, other), models, "this recording cannot distinguish them"
    yield from nearly_as_good(added, model)
    if added.recordings.rows.scope.one_way:
        yield from one_direction(added.recordings, added.extension.fitted.base.coulomb, model)


def _of_motion(effect: Effect) -> bool:
    """Whether it is a lag between torque and reported motion: another such lag of as much looks like it."""
    return isinstance(effect, Lag) and effect.filters_motion


def nearly_as_good(added: Added, model: AxisModel) -> Iterator[Alternatives]:
    """Effects that, instead of the one accepted last, leave hardly more of the torque."""
    whole, suspects = added.extension.fitted, added.suspects
    if not whole.terms or whole.hypothesis != suspects.fitted.hypothesis:
        return
    *kept, named = (term.effect for term in whole.terms)
    for visited in suspects.visited:
        effects = [term.effect for term in visited.terms]
        rivals = [effect for effect in effects if effect not in kept and not effect.decoy]
        if len(rivals) != 1 or len(effects) != len(whole.terms) or not {*kept} <= {*effects}:
            continue
        (rival,) = rivals
        if rival is named or rival.name in named.ambiguous(whole.scope):
            continue
        other = fit(added.recordings.rows, visited.hypothesis, visited)
        if other.rms < NEARLY * whole.rms:
            reason = f"{rival.name} has a residual only {percent(other.rms / whole.rms - 1.0)} larger"
            try:
                instead = stored_model(other, added.extension.outside, added.recordings.rig).model
            except InputError:
                continue
            yield (named.name, rival.name), (model, instead), reason


def one_direction(recordings: Recordings, dry: float, model: AxisModel) -> Iterator[Alternatives]:
    """Dry friction against effects that look like it in one direction, `dry` in total - N*m (N)."""
    direction = 1.0 if float(np.mean(measured_velocity(recordings.trace))) > 0.0 else -1.0
    for effect in catalogue().values():
        if effect.constant:
            values = effect.report([direction * dry], (), Axis(0.0, 0.0, 0.0))
            friction = replace(model.parameters, coulomb_friction=abs(dry))
            nothing = replace(model.parameters, coulomb_friction=0.0)
            instead = replace(model, parameters=nothing, effects=(*model.effects, Present.of(effect.name, values)))
            models = replace(model, parameters=friction), instead
            yield ("coulomb_friction", effect.name), models, "the axis moved in one direction only"


def motions(recordings: Recordings, model: AxisModel) -> list[tuple[str, References]]:
    """Every profile within the limits of the rig, at a coarse tick."""
    tick = max(Cascade.from_rig(recordings.rig).control_period, COARSEST_TICK)
    limits = MotionLimits.from_rig(recordings.rig, model.parameters, tick)
    # a rig need not state a speed; what was recorded is one that the axis has survived
    recorded = [trace for trace in (recordings.trace, recordings.holdout) if trace is not None]
    fastest = max(float(np.abs(measured_velocity(trace)).max()) for trace in recorded)
    limits = replace(limits, speed=min(limits.speed, fastest))
    return [(name, plan(name, limits)) for name in PROFILES if name != "identification"]


def separation(
    recordings: Recordings, models: tuple[AxisModel, AxisModel], references: References, width: float
) -> float:
    """RMS torque - N*m (N) - that one model would miss on the other's recording, through a filter of a width - s."""
    cascade = replace(Cascade.from_rig(recordings.rig), control_period=references.period)
    states = []
    for model in models:
        plant = Plant(model, cascade, references.period)
        states.append(reported_states(plant.model, run(plant, references)))
    smooth = GaussianFilter(max(width, 1.5 * references.period), references.period)
    one, other = states
    torque, shift = smooth(other.torque, 0, 1)
    speed, acceleration = smooth(other.velocity, 0, 1)
    slower, slower_change = smooth(one.velocity, 0, 1)
    parameters = models[0].parameters
    missed = torque - smooth(one.torque, 0)[0] - parameters.inertia * (acceleration - slower_change)
    missed = missed - parameters.viscous_friction_coefficient * (speed - slower)
    sign = np.where(np.abs(speed) > CLEAR * np.abs(speed).max(), np.sign(speed), 0.0)
    from scipy.ndimage import uniform_filter1d  # 0.1 s, which only an open question has to pay

    reach = 2 * round(sign_reach(smooth) / references.period) + 1
    clear = np.abs(uniform_filter1d(sign, reach)) > 1.0 - 1e-9
    if np.count_nonzero(clear) < LEAST:
        return 0.0
    taken_up = np.stack([acceleration, speed, np.sign(speed), shift], axis=1)[clear]
    rest = missed[clear] - taken_up @ np.linalg.lstsq(taken_up, missed[clear], rcond=None)[0]
    return rms(rest)
