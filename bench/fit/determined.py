"""Whether a recording determines a parameter; if not, it is refused with the reason and what to record instead."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from bench.axis_kind import ARMATURE, COULOMB, INERTIA, OFFSET, VISCOUS, AxisKind
from bench.errors import UndeterminedError
from bench.fit.dependence import Dependence
from bench.fit.estimate import Estimate, RefusedEstimateError
from bench.fit.solution import INDEPENDENT_SHARE, NOISE_ALONE, NormalEquations
from bench.names import percent, words
from bench.parameter import Parameter
from bench.rig.rig import Rig

#: Least number of rows for each column of the regression.
ROWS_PER_COLUMN = 20
#: Least share of the effort's variance that a model has to explain.
LEAST_EXPLAINED = 0.5

RECORD = {
    INERTIA: "a motion that accelerates and brakes hard several times",
    VISCOUS: "a motion with at least two clearly different speeds in each direction",
    COULOMB: "a motion in both directions, several seconds each",
}

#: Why a motion does not show a term, as far as it goes without a number.
PLAINLY = {
    INERTIA: "it hardly accelerates",
    VISCOUS: "its speed hardly varies",
    COULOMB: "it hardly moves in both directions",
}

#: What the noise of position or speed hides, and what shows it.
NOISY = {INERTIA: "acceleration", VISCOUS: "speed"}
FINER = "a finer position or speed"

LOAD = "load_moment_of_inertia"
TURNED = "torque and motion counted the same way (a leading - in the rig's [trace.columns] turns one)"
PUSHING = (
    "signals that are sound throughout: a sign that turns, a drop-out or a delay makes friction negative; "
    "otherwise `bench diagnose` searches for what acts in addition to friction"
)
LINKS = "nothing; the MJCF's links, the gear_ratio or the torque are another robot's"
SMALLER = "nothing; the rig's rotor_inertia (gear_inertia, gear_ratio) or torque constant is another one's"
EXPLAINED = "nothing yet; `bench diagnose` searches this recording for what else acts"


def left_open(equations: NormalEquations, kind: AxisKind) -> frozenset[str]:
    """Terms of the equation of motion that rows of every column and a constant do not determine."""
    refused = refusals(equations, kind)
    return frozenset((INERTIA, VISCOUS, COULOMB, OFFSET) if INERTIA in refused else refused)


def require_inertia(equations: NormalEquations, kind: AxisKind) -> None:
    """Raise UndeterminedError if the rows are too few or do not determine the inertia."""
    refused = refusals(equations, kind)
    if INERTIA in refused:
        raise refused[INERTIA]


def require_friction(equations: NormalEquations, kind: AxisKind) -> None:
    """Raise UndeterminedError if the rows do not determine viscous or Coulomb friction."""
    for term, refusal in _not_excited(equations, kind).items():
        if term != INERTIA:
            raise refusal


def refusals(equations: NormalEquations, kind: AxisKind) -> dict[str, UndeterminedError]:
    """Why each term that the rows leave open is, in the order of the report; the inertia's alone if it is one."""
    least, open_terms = ROWS_PER_COLUMN * len(equations.names), _not_excited(equations, kind)
    if equations.count < least:
        reason = f"only {equations.count} filtered samples move clearly in one direction, {least} are needed"
        return {INERTIA: UndeterminedError(kind.in_words(INERTIA), reason, RECORD[INERTIA])}
    if INERTIA in open_terms:
        return {INERTIA: open_terms[INERTIA]}
    if equations.one_way is None:
        return open_terms
    name = f"the split between {kind.in_words(COULOMB)} and {kind.in_words(OFFSET)}"
    one_way = UndeterminedError(name, f"the axis moves {equations.one_way} only", RECORD[COULOMB])
    open_terms.pop(COULOMB, None)
    return {COULOMB: one_way, OFFSET: one_way, **open_terms}


def _not_excited(equations: NormalEquations, kind: AxisKind) -> dict[str, UndeterminedError]:
    """Why each term is not determined of whose column too little is independent of noise and of the others."""
    terms = INERTIA, VISCOUS, COULOMB
    return {
        term: _hidden(term, share, equations.noise_share(term), kind)
        for term, share in zip(terms, equations.independent_shares(terms).tolist(), strict=True)
        if not share >= INDEPENDENT_SHARE
    }


def _hidden(term: str, share: float, noise: float, kind: AxisKind) -> UndeterminedError:
    """Why a term is not determined of whose column's power a share is independent, and a share noise."""
    what = kind.in_words(term)
    if term in NOISY and share + noise >= INDEPENDENT_SHARE:
        reason = f"{percent(min(noise, 1.0))} of the measured {NOISY[term]}'s power is noise"
        return UndeterminedError(what, reason, f"{RECORD[term]}, or {FINER}")
    reason = (
        f"{PLAINLY[term]}: only {percent(max(share, 0.0))} of what would show it differs from other terms and noise"
    )
    return UndeterminedError(what, reason, RECORD[term])


def refused_masses(
    parameters: Mapping[str, Parameter], rig: Rig, suspicions: Sequence[str]
) -> dict[str, UndeterminedError]:
    """Why the inertia, or the load's, is none, by name, with what else is suspicious.

    The interval of the inertia contains zero - which it may where the torque is measured behind the rotor, and links
    are light -, or one of them is surely negative. Without an inertia there is no load's;
    and one that is less than the rotor's alone contradicts the rig, whichever of them is wrong.
    """
    refused: dict[str, UndeterminedError] = {}
    kind, behind_rotor = rig.axis_kind, rig.load is not None and rig.load.behind_rotor
    for name in (kind.inertia, LOAD, ARMATURE):
        found = parameters.get(name)
        if found is None:
            continue
        low, high = found.ci95
        if kind.inertia in refused:
            without = f"{kind.in_words(INERTIA)} is not determined"
            refused[name] = UndeterminedError(words(name), without, refused[kind.inertia].record)
        elif high < 0.0:
            reason = f"it comes out negative, {found.value:.3g} {found.unit} ({low:.3g} to {high:.3g})"
            advice = {kind.inertia: TURNED, ARMATURE: LINKS}.get(name, SMALLER)
            refused[name] = UndeterminedError(words(name), "; ".join([reason, *suspicions]), advice)
        elif name == kind.inertia and low <= 0.0 and not behind_rotor:
            reason = "; ".join([f"its interval, {low:.3g} to {high:.3g} {found.unit}, contains zero", *suspicions])
            refused[name] = UndeterminedError(kind.in_words(INERTIA), reason, RECORD[INERTIA])
    if LOAD in refused and kind.inertia not in refused:
        refused[kind.inertia] = UndeterminedError(kind.in_words(INERTIA), "it is less than the rotor's", SMALLER)
    return refused


def negative_friction(
    parameters: Mapping[str, Parameter], kind: AxisKind, suspicions: Sequence[str]
) -> dict[str, UndeterminedError]:
    """Why a friction is none, by name, with what else is suspicious: its interval lies below zero."""
    refused = {}
    for term in (VISCOUS, COULOMB):
        name, one = kind.parameter(term), parameters.get(kind.parameter(term))
        if one is not None and one.ci95[1] < 0.0:
            reason = f"it comes out negative, {one.value:.3g} {one.unit} (at most {one.ci95[1]:.3g})"
            refused[name] = UndeterminedError(words(name), "; ".join([reason, *suspicions]), PUSHING)
    return refused


def _share(estimate: Estimate, kind: AxisKind) -> str:
    return f"inertia and friction explain {percent(estimate.explained)} of the {kind.effort}'s variance"


def remainder(estimate: Estimate, kind: AxisKind, hint: str, depends: Dependence | None) -> tuple[str, ...]:
    """How much is explained, and how large the residual is, where that is more than noise; else on what it depends."""
    residual = estimate.residual
    if not residual.rms > NOISE_ALONE * residual.noise_floor:
        return () if depends is None else (f"{depends}. The intervals include its influence",)
    times = f"the residual is {residual.rms / residual.noise_floor:.3g} times the sensor noise"
    return _share(estimate, kind), f"{times}, {hint}" if hint else times


def sound(estimate: Estimate, equations: NormalEquations, rig: Rig, suspicions: Sequence[str]) -> Estimate:
    """The estimate, if its equations, of every column and a constant, determine it and it means something.

    It means nothing where its inertia may be zero or is negative, the load's is negative, a friction surely is, or the
    model explains less than half of the effort's variance: RefusedEstimateError with what is determined, and with what
    else is suspicious.
    """
    kind, reasons = rig.axis_kind, [*refusals(equations, rig.axis_kind).values()]
    negative = negative_friction(estimate.parameters, kind, suspicions)
    if estimate.explained < LEAST_EXPLAINED:  # then more acceleration does not help
        why = "; ".join(dict.fromkeys([_share(estimate, kind), *suspicions]))
        reasons.append(UndeterminedError(f"{kind.in_words(INERTIA)} and friction", why, EXPLAINED))
    reasons += [*refused_masses(estimate.parameters, rig, suspicions).values(), *negative.values()]
    if not reasons:
        return estimate
    unknown = {kind.parameter(term) for term in left_open(equations, kind)} | negative.keys()
    determined = {name: value for name, value in estimate.parameters.items() if name not in unknown}
    raise RefusedEstimateError(reasons[0], replace(estimate, parameters=determined)) from reasons[0]
