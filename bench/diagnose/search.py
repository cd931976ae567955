"""Name what is missing: try every effect, keep what explains, polish it, let go of what a later one explains.

Stop, accept and "unexplained" are tests against the noise floor of the recording itself (chi = 1 where only noise is
left), so a recording in which nothing is hidden ends without a name.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.backlash import with_backlash
from bench.diagnose.candidates import EVENT, Candidate, candidates
from bench.diagnose.fit import Fit, fit
from bench.diagnose.grids import spacing
from bench.diagnose.hypothesis import (
    BACKLASH,
    CURRENT_LAG,
    ELASTIC,
    SPRING,
    TRANSFORMS,
    Hypothesis,
    Named,
)
from bench.diagnose.load_side import outer_loads
from bench.diagnose.mains import humming
from bench.diagnose.outside import OUTSIDE
from bench.diagnose.shapes import is_pitch_of, shaped
from bench.diagnose.workbench import Workbench
from bench.effects.catalogue import catalogue

OFFSET, STRIBECK = "torque_offset", "stribeck_friction"

#: Residual over noise floor above which what is left stands clearly above noise.
REMAINDER = 1.12
#: Longest events together, as share of the recording; beyond, it is not an event but how the axis is.
LONGEST_EVENT = 0.6
#: Share of what stands above the floor that an effect must explain to be taken up.
SHARE = 0.25
#: The same for an event, which has a window of time to choose freely and so fits a part of anything.
EVENT_SHARE = 0.5
#: The same for a pitch that repeats so many half cycles over the travel of a linear axis that no smooth error of the
#: model copies it.
PITCH_SHARE, MANY = 0.1, 20.0
#: Gain over noise power per degree of freedom that chance does not reach in a search over some hundred candidates.
SIGNIFICANT = 40.0
#: Share of the highest speed within which a rise towards standstill ends; a wider one is curvature, as drag has it.
#: Weak drag without its name was met by rises of 0.20 to 0.29; true ones drawn end within 0.06.
RISE = 0.2
#: Damping ratio from which a coupling no longer rings, so that nothing tells it from a lag.
OVERDAMPED = 1.0
#: Candidates whose shapes are polished before they are compared.
FINALISTS = 4
#: Effects at most.
MOST = 5


@dataclass(frozen=True)
class Step:
    """An effect taken up: its hypothesis fitted, and the candidates it was chosen from, best first."""

    fitted: Fit
    rivals: tuple[Candidate, ...]


def search(bench: Workbench, rotor_inertia: float, excluded: frozenset[str] = frozenset()) -> list[Step]:
    """Hypotheses in the order in which effects were added; the first has none.

    Args:
        bench: the recording.
        rotor_inertia: of the motor alone, 0 where the rig does not tell - kg*m**2 (kg).
        excluded: effects not to be tried.
    """
    steps = grown(bench, [Step(humming(bench, fit(bench, Hypothesis())), ())], excluded)
    last = steps[-1].fitted
    if last.chi > REMAINDER and BACKLASH not in excluded:
        loose = loosened(bench, last, rotor_inertia)
        if loose is not None:
            loose = eliminated(bench, loose)
            steps = grown(
                bench, [*steps[:-1], Step(loose, ())] if len(steps) > 1 else [*steps, Step(loose, ())], excluded
            )
    return steps


def grown(bench: Workbench, steps: list[Step], excluded: frozenset[str]) -> list[Step]:
    """Steps with effects of the catalogue added until none is worthwhile.

    Beside a dead zone no event is sought: what its unknown contact leaves comes in bursts, too.
    """
    while len(steps) <= MOST:
        current = steps[-1].fitted
        bursts = {EVENT} if BACKLASH in current.hypothesis.names else set()
        tried = candidates(bench, current, excluded | frozenset(OUTSIDE) | bursts)
        threshold = SIGNIFICANT * row_correlation(bench) * current.floor**2
        promising = [candidate for candidate in tried if candidate.gain > max(threshold, 0.1 * current.excess)]
        finalists = [refined(bench, current, candidate) for candidate in promising[:FINALISTS]]
        better = [found for found in finalists if worthwhile(bench, current, found)]
        if not better:
            break
        chosen = min(better, key=lambda found: float(np.sum(found.residual**2)))
        steps = [*steps, Step(humming(bench, eliminated(bench, loaded(bench, polished(bench, chosen)))), tuple(tried))]
    return steps


def loosened(bench: Workbench, fitted: Fit, rotor_inertia: float) -> Fit | None:
    """The hypothesis with a dead zone instead of an elastic coupling, if that explains clearly more.

    Clearly more is half of what stands above noise where no instant of an impact matters, and no less elsewhere.
    """
    if BACKLASH in fitted.hypothesis.names:
        return None
    kept = tuple(effect for effect in fitted.hypothesis.effects if effect.name not in (ELASTIC, CURRENT_LAG))
    hypothesis = Hypothesis(kept)
    rates = {0.0}
    if SPRING in hypothesis.names and fitted.theta[0] > rotor_inertia:
        stiffness = fit(bench, hypothesis).strengths(hypothesis.names.index(SPRING))[0]
        rates.add(float(max(stiffness, 0.0) / (fitted.theta[0] - rotor_inertia)))
    found = with_backlash(bench, hypothesis, rates)
    share = found.strengths(len(kept))[0] / found.theta[0]
    left = bench.effort - found.columns @ found.theta
    before, after = float(np.sum(fitted.residual[found.told] ** 2)), float(np.sum(found.residual**2))
    excess = before - np.count_nonzero(found.told) * fitted.floor**2
    clearly = before - after > 0.5 * max(excess, 0.0) and np.sum(left**2) < np.sum(fitted.residual**2)
    return found if clearly and found.told.mean() > 0.5 and 0.02 < share < 0.98 else None


def worthwhile(bench: Workbench, before: Fit, after: Fit) -> bool:
    """Whether an added effect explains enough, significantly, within what physics allows.

    Noise is what the less coloured of the two floors says: an effect that never pauses, such as the cogging of a steady
    speed, passes for coloured noise until it is named. White noise is that of the model before: an effect that filters
    speed or copies torque lowers its own, and what it damps of noise it does not explain.
    """
    damped = np.count_nonzero(before.told) * max(before.white**2 - after.white**2, 0.0)
    saved = float(np.sum(before.residual**2) - np.sum(after.residual**2)) - damped
    noise = min(before.floor, after.floor * before.white / after.white) ** 2
    excess = max(float(np.sum(before.residual**2)) - np.count_nonzero(before.told) * noise, 0.0)
    correlation = row_correlation(bench)
    added = after.theta.size - before.theta.size + len(after.hypothesis.effects[-1].shape)
    significant = saved > SIGNIFICANT * added * correlation * noise
    share = _share(bench, after.hypothesis.effects[-1])
    return significant and 0.0 < share * (before.excess or excess) < saved and physical(after, bench.duration)


def _share(bench: Workbench, effect: Named) -> float:
    if effect.name == EVENT:
        return EVENT_SHARE
    return PITCH_SHARE if is_pitch_of(effect, bench) and effect.shape[0] > MANY * spacing(bench) else SHARE


def row_correlation(bench: Workbench) -> float:
    """Variance of a sum of filtered noise over that of independent rows: 2*sqrt(pi)*width over the rows' distance."""
    smooth = bench.conditioning.filter
    return max(1.0, 2.0 * np.sqrt(np.pi) * smooth.width / (smooth.stride * smooth.sample_period))


def physical(fitted: Fit, duration: float) -> bool:
    """Whether every effect has values that physics allows, in a recording of a duration - s."""
    events = sum(e.shape[1] - e.shape[0] for e in fitted.hypothesis.effects if e.name == EVENT)
    if events > LONGEST_EVENT * duration:
        return False
    for index, effect in enumerate(fitted.hypothesis.effects):
        strengths = fitted.strengths(index)
        if effect.name in (ELASTIC, BACKLASH) and not 0.02 < strengths[0] / fitted.theta[0] < 0.98:
            return False
        if effect.name == STRIBECK and effect.shape[0] > RISE * np.abs(fitted.columns[:, 1]).max():
            return False
        if effect.name == ELASTIC and effect.shape[1] >= OVERDAMPED:
            return False
        if effect.name in TRANSFORMS or effect.name in OUTSIDE:
            continue
        if not catalogue()[effect.name].physical(strengths.tolist(), effect.shape, fitted.base):
            return False
    return fitted.theta[0] > 0.0


def refined(bench: Workbench, current: Fit, candidate: Candidate) -> Fit:
    """The candidate added, its shape searched around where the grid found it."""
    return shaped(bench, current.hypothesis.with_effect(candidate.named), len(current.hypothesis.effects))


def polished(bench: Workbench, fitted: Fit) -> Fit:
    """Every effect's shape searched again beside the others."""
    if len(fitted.hypothesis.effects) < 2:
        return fitted
    for index in range(len(fitted.hypothesis.effects)):
        tried = shaped(bench, fitted.hypothesis, index)
        fitted = tried if physical(tried, bench.duration) else fitted
    return fitted


def loaded(bench: Workbench, fitted: Fit) -> Fit:
    """With outer loads on the side of a soft coupling, motor or load, on which they explain more, if much is left."""
    if fitted.chi < REMAINDER or not outer_loads(fitted.hypothesis):
        return fitted
    other = replace(fitted.hypothesis, loads=() if fitted.hypothesis.loads is None else None)
    moved = shaped(bench, other, other.names.index(ELASTIC))
    return min(fitted, moved, key=lambda found: float(np.sum(found.residual**2)))


def eliminated(bench: Workbench, fitted: Fit) -> Fit:
    """Without the effects that no longer explain anything beside the later ones."""
    correlation = row_correlation(bench)
    for index in range(len(fitted.hypothesis.effects) - 1, -1, -1):
        if len(fitted.hypothesis.effects) < 2:
            break
        less = fit(bench, fitted.hypothesis.without(index))
        lost = float(np.sum(less.residual**2) - np.sum(fitted.residual**2))
        own = fitted.strengths(index).size + len(fitted.hypothesis.effects[index].shape)
        if lost < SIGNIFICANT * max(own, 1) * correlation * fitted.floor**2 or lost < 0.02 * less.excess:
            fitted = less
    return fitted
