"""Add the named effects to the MuJoCo model and keep what motion that was not fitted bears out.

An effect is accepted if, with it, neither the torque gap nor the velocity gap of unseen motion grows. A change that
the simulation's own floor hides - an offset that integral action takes up - is no verdict, nor is a simulation that is
further off than the mean speed would be - a held motor that slips from cog to cog: then the torque gap alone
decides. An effect of drive or sensor that torque and held velocity both leave as they were is judged where it shows:
a voltage limit under the drive of the rig.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.added import BANDWIDTH, holding_bandwidth
from bench.diagnose.balance import Balance
from bench.diagnose.candidates import EVENT
from bench.diagnose.chain import Chain, Grown
from bench.diagnose.closed_loop import closed_loop_gap
from bench.diagnose.found import Rejected
from bench.diagnose.held import Recorded, VelocityGaps
from bench.diagnose.holdout import foreign
from bench.diagnose.name import Suspects, named
from bench.diagnose.polish import Numbers
from bench.diagnose.recordings import Recordings
from bench.diagnose.refine import NULL, Refined, refined, refined_model
from bench.diagnose.unseen import HOLDOUT, RECORDING, Unseen
from bench.diagnose.voltage import VOLTAGE_LIMIT
from bench.diagnose.workbench import Workbench
from bench.plant.track import measured_velocity
from bench.trace.noise import white_noise


@dataclass(frozen=True)
class Added:
    """What was kept.

    Attributes:
        chain: the effects accepted, fitted to the whole recording.
        unseen: motion that judged them.
        gaps: velocity gaps, those of every addition simulated.
        recorded: the recording, and the holdout where there is one.
        rejected: effects not kept, with the reason.
        refined: the model kept, its quantities refined by simulation where that helps.
        repeats: whether the recording's events happen in the holdout too.
        warnings: that the holdout is of another axis, or that MuJoCo cannot have the model.
        closed_loop: velocity gap under the drive of the rig without and with what shows only there - rad/s (m/s); None
            where nothing does.
    """

    chain: Chain
    unseen: Unseen
    gaps: VelocityGaps
    recorded: tuple[Recorded, ...]
    rejected: tuple[Rejected, ...]
    refined: Refined
    repeats: bool
    warnings: tuple[str, ...]
    closed_loop: tuple[float, float] | None


def add(recordings: Recordings, suspects: Suspects) -> Added:
    """Try every effect and keep those that unseen motion bears out; refine the model of those."""
    found = suspects.steps[-1].fitted
    warnings = foreign(recordings.bench, found, recordings.other)
    repeats = everywhere(Balance.of(recordings.bench, found), recordings.other)
    unseen = Unseen.of(recordings, not warnings, repeats)
    recorded = [Recorded.of(RECORDING, recordings.trace, recordings.rig)]
    if recordings.holdout is not None:
        recorded.append(Recorded.of(HOLDOUT, recordings.holdout, recordings.rig, events=repeats))
    chain = Chain(recordings.bench, RECORDING, found.hypothesis, suspects.beside, recordings.rig)
    closed_loop = None
    if VOLTAGE_LIMIT in chain.names:
        closed_loop = closed_loop_gap(recordings, chain.less(chain.names.index(VOLTAGE_LIMIT)).whole, chain.whole)
    rejected: list[Rejected] = []
    while True:
        trial = Trial.of(recordings, suspects, unseen, chain)
        trial.gaps.simulate([*trial.pairs, *((grown, each) for grown in chain.grown for each in recorded)])
        against = rejection(trial) or unlimited(chain, closed_loop)
        if against is None:
            break
        rejected.append(Rejected(chain.names[against[0]], against[1]))
        chain = chain.less(against[0])
    kept = refined(recordings, chain.whole, suspects, unseen, trial.gaps)
    problem = [f"not added to the MuJoCo model: {chain.whole.problem}"] if chain.whole.problem else []
    told = (*warnings, *problem)
    return Added(chain, unseen, trial.gaps, tuple(recorded), tuple(rejected), kept, repeats, told, closed_loop)


def everywhere(balance: Balance, other: Workbench | None) -> bool:
    """Whether events come in every recording: the holdout shows them at the same time of its own."""
    if other is None or EVENT not in balance.hypothesis.names:
        return False
    return balance.repeating(True).gap(other) < balance.gap(other)


def bandwidth(chain: Chain, recordings: Recordings) -> float:
    """Bandwidth that holds every model of a chain - rad/s."""
    stored = chain.whole.model
    top = float(np.abs(measured_velocity(recordings.trace)).max())
    return BANDWIDTH if stored is None else holding_bandwidth(stored.model, top)


@dataclass(frozen=True)
class Trial:
    """Effects before unseen motion.

    Attributes:
        recordings, suspects: as added.
        unseen: the motion.
        gaps: of velocity.
        judged: all effects, fitted to seen motion.
        without: the same less each one of them.
    """

    recordings: Recordings
    suspects: Suspects
    unseen: Unseen
    gaps: VelocityGaps
    judged: Chain
    without: tuple[Chain, ...]

    @classmethod
    def of(cls, recordings: Recordings, suspects: Suspects, unseen: Unseen, chain: Chain) -> Trial:
        """The effects of a chain, refitted to what may be seen."""
        judged = replace(chain, bench=unseen.fitted, rows=unseen.rows)
        laid_out_for = chain.whole if chain.whole.model is not None else chain.grown[0]
        gaps = VelocityGaps(bandwidth(chain, recordings), float(laid_out_for.fitted.theta[0]))
        without = tuple(judged.less(index) for index in range(len(chain.names)))
        return cls(recordings, suspects, unseen, gaps, judged, without)

    @property
    def pairs(self) -> list[tuple[Grown, Recorded]]:
        """What has to be simulated to judge."""
        chains = (self.judged, *self.without) if self.without else ()
        return [(chain.whole, self.unseen.recorded) for chain in chains]


def rejection(trial: Trial) -> tuple[int, str] | None:
    """The last effect that unseen motion speaks against, and why; None if it speaks against none."""
    unseen, judged = trial.unseen, trial.judged
    floor = NULL * white_noise(measured_velocity(trial.recordings.trace))
    for index in reversed(range(len(judged.names))):
        less = trial.without[index]
        if judged.names[index] == EVENT and (not unseen.recorded.events or unseen.rows != RECORDING):
            continue
        torque = tuple(each.balance(unseen.recorded.events).gap(unseen.bench) for each in (less, judged))
        if torque[1] > torque[0]:
            return index, _grows("torque", torque, judged.rig.effort_unit, unseen)
        velocity = trial.gaps.of(less.whole, unseen.recorded), trial.gaps.of(judged.whole, unseen.recorded)
        allowed = float(np.hypot(velocity[0], floor))
        follows = min(velocity) < unseen.recorded.varies
        if follows and velocity[1] > allowed and not _comes_closer(trial, allowed):
            return index, _grows("velocity", velocity, "m/s" if judged.rig.linear else "rad/s", unseen)
    return None


def _comes_closer(trial: Trial, allowed: float) -> bool:
    """Whether the velocity gap of all effects comes below what is allowed once they are refined by simulation."""
    whole = trial.judged.whole
    if whole.model is None:
        return True
    numbers = Numbers.of(*named(replace(trial.recordings, bench=trial.judged.bench), whole, trial.suspects))
    found = refined_model(whole.model, numbers, trial.unseen, trial.gaps)
    return found is not None and found.gap is not None and found.gap[1] <= allowed


def unlimited(chain: Chain, closed_loop: tuple[float, float] | None) -> tuple[int, str] | None:
    """The voltage limit, if the axis under its drive does not come closer to the recording with it."""
    if closed_loop is None or closed_loop[1] < closed_loop[0] or VOLTAGE_LIMIT not in chain.names:
        return None
    reason = f"the velocity gap under the rig's drive grows with it: {closed_loop[0]:.3g} -> {closed_loop[1]:.3g}"
    return chain.names.index(VOLTAGE_LIMIT), reason


def _grows(what: str, gap: tuple[float, ...], unit: str, unseen: Unseen) -> str:
    return f"the {what} gap of the {unseen.recorded.name} grows with it: {gap[0]:.3g} -> {gap[1]:.3g} {unit}"
