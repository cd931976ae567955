"""The motion that tells two explanations apart best: both models are simulated along every profile the rig can follow.

Two explanations remain where names are ambiguous, where a rival leaves hardly more of the torque than what was named,
or where motion in one direction does not part dry friction from a constant torque. What a profile shows is the torque
that one model would miss on the other's recording,

    e = dM - J*d(dw)/dt - K_w*dw,

dM, dw - differences of reported torque and velocity under the same drive - through the diagnosis' filter, less what
other values of J, K_w, K_0 and a shift in time would take up; against the noise floor of the recording at hand.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from bench.diagnose.add import Added
from bench.diagnose.added import stored_model
from bench.diagnose.decidable import one_way
from bench.diagnose.fit import fit
from bench.diagnose.hypothesis import CURRENT_LAG, DIRECTION, VELOCITY_LAG
from bench.diagnose.name import Suspects
from bench.diagnose.outside import OUTSIDE
from bench.diagnose.recordings import Recordings
from bench.diagnose.search import OFFSET
from bench.diagnose.workbench import SIGN_WIDTHS
from bench.effects.present import Present
from bench.errors import BenchError, InputError
from bench.plant.axis_model import AxisModel
from bench.plant.drive import Cascade
from bench.plant.limits import MotionLimits
from bench.plant.plant import Plant
from bench.plant.profiles import PROFILES, plan
from bench.plant.references import References
from bench.plant.run import run
from bench.plant.sensing import reported_states
from bench.plant.track import measured_velocity
from bench.trace.filter import GaussianFilter

Array = NDArray[np.float64]

#: Effects that are the same wherever the axis moves, so that no motion tells them apart.
SAME = {OFFSET, DIRECTION}
#: Least duration of a recording that tells anything - s: a shorter profile is repeated.
LONG_ENOUGH = 4.0
#: RMS of what remains with a rival over that with what was named, below which both remain.
NEARLY = 1.1
#: Separation, in noise floors, below which an experiment tells nothing.
TELLS = 3.0
#: Tick of the drive at least - s: profiles are compared, not recorded.
COARSEST_TICK = 0.5e-3
#: Share of the top speed below which the direction of motion is in doubt, and samples of clear direction needed.
CLEAR, LEAST = 0.01, 50


@dataclass(frozen=True)
class NextExperiment:
    """A motion to record.

    Attributes:
        profile: of `bench simulate --profile`.
        speed, acceleration: highest of it - rad/s, rad/s**2 (m/s, m/s**2).
        duration: of one run - s.
        repetitions: of it, one after the other.
        tells_apart: what was named and its rival.
        separation: of the two, over the noise floor.
        reason: why it is needed.
    """

    profile: str
    speed: float
    acceleration: float
    duration: float
    repetitions: int
    tells_apart: tuple[str, str]
    separation: float
    reason: str


@dataclass(frozen=True)
class Rival:
    """Two explanations, as models."""

    names: tuple[str, str]
    models: tuple[AxisModel, AxisModel]
    reason: str


def propose(recordings: Recordings, suspects: Suspects, added: Added) -> NextExperiment | None:
    """The experiment for the first two explanations that one can tell apart; None where one explanation remains."""
    stored = added.refined.model
    if stored is None or recordings.rig.drive is None:
        return None
    width, floor = recordings.bench.conditioning.filter.width, added.chain.whole.fitted.floor
    for rival in rivals(recordings, suspects, added, stored.model):
        try:
            found = [
                (separation(recordings, rival.models, references, width) / floor, name, references)
                for name, references in motions(recordings, stored.model)
            ]
        except BenchError:
            continue
        best, name, references = max(found, key=lambda tried: tried[0])
        if best > TELLS:
            speed, acceleration = (float(np.abs(v).max()) for v in (references.velocity, references.acceleration))
            duration = float(references.time[-1])
            again = int(np.ceil(LONG_ENOUGH / duration))
            return NextExperiment(name, speed, acceleration, duration, again, rival.names, best, rival.reason)
    return None


def rivals(recordings: Recordings, suspects: Suspects, added: Added, model: AxisModel) -> Iterator[Rival]:
    """Other explanations that remain, as models."""
    for effect in added.refined.effects:
        for other in effect.ambiguous_with:
            values = {key: p.value for key, p in effect.parameters.items()}
            like = counterpart(other, values)
            if like is not None:
                kept = [present for present in model.effects if present.name != effect.name]
                models = model, model.with_effects([*kept, like])
                yield Rival((effect.name, other), models, "this recording cannot tell them apart")
    whole = added.chain.whole.fitted
    yield from nearly_as_good(recordings, suspects, added, model)
    if one_way(recordings.bench):
        yield one_direction(recordings, float(whole.theta[2]), model)


def nearly_as_good(recordings: Recordings, suspects: Suspects, added: Added, model: AxisModel) -> Iterator[Rival]:
    """Candidates of the search in the place of the effect taken up last that leave hardly more of the torque."""
    whole = added.chain.whole.fitted
    last = suspects.steps[-1]
    if whole.hypothesis.effects and whole.hypothesis == last.fitted.hypothesis:
        for candidate in last.rivals[:3]:
            name = candidate.named.name
            if name in OUTSIDE or name in whole.hypothesis.names or {name, whole.hypothesis.names[-1]} == SAME:
                continue
            index = len(whole.hypothesis.effects) - 1
            other = fit(recordings.bench, whole.hypothesis.without(index).with_effect(candidate.named))
            if other.rms < NEARLY * whole.rms:
                reason = f"{name} leaves but {other.rms / whole.rms - 1.0:.0%} more of the torque unexplained"
                try:
                    rival = stored_model(other, added.chain.beside, recordings.rig).model
                except InputError:
                    continue
                yield Rival((whole.hypothesis.names[-1], name), (model, rival), reason)


def one_direction(recordings: Recordings, dry: float, model: AxisModel) -> Rival:
    """Dry friction against a constant torque, which together make the constant part `dry` of what resists - N*m (N)."""
    direction = 1.0 if float(np.mean(measured_velocity(recordings.trace))) > 0.0 else -1.0

    def split(friction: float) -> AxisModel:
        constant = Present.of(OFFSET, {"torque": direction * (dry - friction)})
        parameters = replace(model.parameters, coulomb_friction=friction)
        return replace(model, parameters=parameters, effects=(*model.effects, constant))

    names = ("coulomb_friction", OFFSET)
    return Rival(names, (split(abs(dry)), split(0.0)), "the axis moved in one direction only")


def counterpart(name: str, values: dict[str, float]) -> Present | None:
    """The effect that looks the same as another one of given values in some motion; None if it does in every one.

    A constant torque and dry friction that differs between the directions are the same wherever the axis moves.
    """
    return Present.of(name, {"time_constant": values["time_constant"]}) if name in (CURRENT_LAG, VELOCITY_LAG) else None


def motions(recordings: Recordings, model: AxisModel) -> list[tuple[str, References]]:
    """Every profile inside the limits of the rig, at a tick that is quick to simulate."""
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
    """RMS torque that one model would miss on the other's recording of a motion - N*m (N).

    Args:
        recordings: whose rig drives both.
        models: the two explanations.
        references: the motion.
        width: of the diagnosis' filter - s.
    """
    cascade = replace(Cascade.from_rig(recordings.rig), control_period=references.period)
    states = []
    for model in models:
        plant = Plant(model.parameters, cascade, references.period, effects=model.effects, winding=model.winding)
        states.append(reported_states(plant.model, run([plant], [references])))
    smooth = GaussianFilter(max(width, 1.5 * references.period), references.period)
    one, other = states
    torque, shift = smooth(other.torque[:, 0], 0, 1)
    less = smooth(one.torque[:, 0], 0)[0]
    speed, acceleration = smooth(other.velocity[:, 0], 0, 1)
    slower, slower_change = smooth(one.velocity[:, 0], 0, 1)
    parameters = models[0].parameters
    missed = torque - less - parameters.inertia * (acceleration - slower_change)
    missed = missed - parameters.viscous_friction_coefficient * (speed - slower)
    sign = np.where(np.abs(speed) > CLEAR * np.abs(speed).max(), np.sign(speed), 0.0)
    reach = 2 * round(SIGN_WIDTHS * smooth.width / references.period) + 1
    clear = np.abs(uniform_filter1d(sign, reach)) > 1.0 - 1e-9
    if np.count_nonzero(clear) < LEAST:
        return 0.0
    taken_up = np.stack([acceleration, speed, np.sign(speed), shift], axis=1)[clear]
    rest = missed[clear] - taken_up @ np.linalg.lstsq(taken_up, missed[clear], rcond=None)[0]
    return float(np.sqrt(np.mean(rest**2)))
