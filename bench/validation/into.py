"""The diagnosis of known effects that are put into a recording: how large each has to be to be named."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.diagnosis.diagnosis import Diagnosis, diagnose
from bench.effects.catalogue import catalogue
from bench.effects.effect import EncoderFault, Lag
from bench.errors import BenchError, InputError, UndeterminedError
from bench.jobs.each import each
from bench.jobs.process import Failure, Limits
from bench.names import nearest
from bench.rig.rig import Rig
from bench.trace.trace import Trace
from bench.validation.coverage import UNEXPLAINED, Named, Scored, of_effects
from bench.validation.independent.effects import KINDS
from bench.validation.independent.rig import Axis
from bench.validation.injection import INJECTABLE, Host, disturbance, drawn, injected, stand_in

#: What becomes of an effect. Right: named, and nothing else is that was not before; part: something else, too; flagged:
#: not named, and there is a remainder or a refusal; missed: neither; wrong: not named, and something else is.
RIGHT, PART, FLAGGED, MISSED, WRONG = FATES = ("right", "part", "flagged", "missed", "wrong")
#: Effects whose torque a gear carries.
LOADS = frozenset(name for name, kind in KINDS.items() if kind.transmitted)
#: Strengths between which the least is sought, over the recording's residual, and how often: its step is then 19 %.
SPAN, TRIALS = (0.1, 25.6), 5
#: For one effect: ten times what five diagnoses of a large recording take - s.
DEADLINE = 3600.0


@dataclass(frozen=True)
class Own:
    """A recording before anything is put into it, as its own diagnosis sees it.

    Attributes:
        host: the recording, and its axis as diagnosed.
        names, verdict: of its own diagnosis.
        taken: these names, and what it cannot distinguish from them.
        left, unit: RMS residual, noise included, and its unit.
    """

    host: Host
    names: tuple[str, ...]
    verdict: str
    taken: frozenset[str]
    left: float
    unit: str


def own(trace: Trace, rig: Rig) -> Own:
    """By a diagnosis of the recording as it is, which may refuse it as `diagnose` does."""
    found = diagnose(trace, rig)
    source = "position" if "position" in trace else "velocity"
    lags = [(one.effect, one.values["time_constant"]) for one in found.effects if isinstance(one.effect, Lag)]
    lag = sum(effect.delays([constant], source)[0] for effect, constant in lags)
    plain = Host(trace, rig, axis_of(found, trace, rig), moved=_moved(trace, found), lag=lag)
    left, gap = found.torque.identify, found.torque
    assert left is not None
    taken = frozenset(name for one in found.effects for name in (one.name, *one.ambiguous_with))
    names = tuple(one.name for one in found.effects)
    return Own(replace(plain, load=_load(plain, found)), names, found.verdict, taken, left[1], gap.unit)


def axis_of(found: Diagnosis, trace: Trace, rig: Rig) -> Axis:
    """The axis as a diagnosis found it; half of its inertia is the load's where the rig does not state the rotor's.

    Raises:
        UndeterminedError: the diagnosis does not determine the inertia.
    """
    kind = rig.axis_kind
    if kind.inertia in found.refused:
        record = "one whose own diagnosis determines it, to put effects into"
        raise UndeterminedError(kind.in_words(INERTIA), found.refused[kind.inertia], record)
    values = (found.parameters[kind.parameter(term)].value for term in (INERTIA, VISCOUS, COULOMB))
    inertia, viscous, coulomb = values
    constant, rotor = rig.motor.torque_per_ampere, rig.motor.inertia
    per_ampere = 1.0 if constant is None else constant.constant
    axis = Axis(
        name=rig.name,
        inertia=inertia,
        viscous=max(viscous, 0.0),
        coulomb=max(coulomb, 0.0),
        rotor_inertia=rotor if 0.0 < rotor < inertia else 0.5 * inertia,
        torque_constant=per_ampere,
        peak_current=rig.motor.peak_current or float(np.abs(rig.effort(trace)[0]).max()) / per_ampere,
        velocity_gain=100.0 * inertia,  # a drive of 16 Hz, which bears lags of some milliseconds
        linear=not kind.turns,
    )
    return replace(axis, top_speed=float(np.abs(stand_in(Host(trace, rig, axis)).velocity).max()))


def _moved(trace: Trace, found: Diagnosis) -> Trace | None:
    """The recording without the errors of its sensors of motion that its diagnosis names; None without them."""
    misread = [(one.effect, one.values) for one in found.effects if isinstance(one.effect, EncoderFault)]
    if not misread or not {"position", "velocity"} <= trace.signals.keys():
        return None
    position, velocity = trace["position"], trace["velocity"]
    for effect, values in misread:
        position, velocity = effect.actual(values, position, velocity)
    return trace.with_signals({"position": position, "velocity": velocity}, {})


def _load(host: Host, found: Diagnosis) -> Array | None:
    """Torque of the load of the rig, or that the diagnosis names - N*m (N) (m,)."""
    known = host.rig.effort(host.trace)[0] - host.rig.own_effort(host.trace)[0]
    loads = [KINDS[one.name](**one.values) for one in found.effects if one.name in LOADS]
    if not loads and not known.any():
        return None
    seen = stand_in(host)
    return sum((np.asarray(load.resisting_torque(seen)) for load in loads), known)


@dataclass(frozen=True)
class Injection:
    """An effect put into a recording, and its diagnosis.

    Attributes:
        effect, strength: its name, and the RMS torque that J, K_w and K_0 cannot take up of it over what the recording
            residual.
        quantity, size, unit: its size, the first quantity of its name.
        torque: RMS of all its torque - unit of `Own.left`.
        fate: one of `FATES`.
        names: given now, and not before.
        verdict, reason: of the diagnosis; why there is none.
        scored: its quantities with the truth, where it is named.
    """

    effect: str
    strength: float
    quantity: str
    size: float
    unit: str
    torque: float
    fate: str = FLAGGED
    names: tuple[str, ...] = ()
    verdict: str = ""
    reason: str = ""
    scored: tuple[Scored, ...] = ()

    @property
    def named(self) -> bool:
        """Whether the effect is named."""
        return self.fate in (RIGHT, PART)


def put_into(own: Own, name: str, strength: float, seed: int) -> Injection | None:
    """Put an effect into a recording and diagnose it; None if the axis cannot have it, or has it already.

    Args:
        own: the recording.
        name: of the effect.
        strength: over the recording's residual.
        seed: of its other parameters.
    """
    effect = None if name in own.taken else drawn(own.host, name, strength * own.left, seed)
    if effect is None:
        return None
    host, known = own.host, catalogue()[name].quantities[0]
    made, size = injected(host, effect), effect.quantities(host.axis)[known.name]
    unit = host.rig.axis_kind.unit(known, own.unit)
    case = Injection(name, strength, known.name, size, unit, disturbance(host, made)[0])
    try:
        found = diagnose(made, host.rig)
    except BenchError as refused:
        return replace(case, reason=" ".join(str(refused).split()))
    became, new = fate(found, name, own.names)
    scored = tuple(of_effects([effect], host.axis, found))
    return replace(case, fate=became, names=new, verdict=found.verdict, scored=scored)


def fate(found: Diagnosis, effect: str, beside: Sequence[str]) -> tuple[str, tuple[str, ...]]:
    """What becomes of an effect in a diagnosis, one of `FATES`, and the names given but for those of other effects."""
    named = Named.of(found.verdict, found.effects, (*beside, effect))
    if effect not in named.missed:
        return PART if named.false else RIGHT, (effect, *named.false)
    return WRONG if named.false else FLAGGED if found.verdict == UNEXPLAINED else MISSED, named.false


def tried(
    own: Own,
    strengths: Sequence[float],
    seed: int,
    name: str,
    trial: Callable[[Own, str, float, int], Injection | None] = put_into,
) -> tuple[Injection, ...]:
    """One effect at each strength asked for, or without any at those that close in on the least that is named.

    Arguments as `inject` and `put_into` have them; `trial` tries one strength.
    """
    if strengths:
        at = (trial(own, name, strength, seed) for strength in strengths)
        return tuple(case for case in at if case is not None)
    (low, high), cases = SPAN, []
    for _ in range(TRIALS):
        middle = math.sqrt(low * high)
        case = trial(own, name, middle, seed)
        low, high = (low, middle) if case is not None and case.named else (middle, high)
        cases += [] if case is None else [case]
    return tuple(cases)


@dataclass(frozen=True)
class Injections:
    """What became of known effects in a recording.

    Attributes:
        own: the recording.
        cases: what was tried, by effect and strength.
        sought: whether the least that is named was sought.
        unable: names that the axis cannot have, at no strength that was tried, or has already.
        failed: names whose work gave no result, and why.
    """

    own: Own
    cases: tuple[Injection, ...]
    sought: bool
    unable: tuple[str, ...]
    failed: Mapping[str, str]

    @property
    def least(self) -> dict[str, Injection | None]:
        """By effect the weakest that was named; None of one that never was."""
        found: dict[str, Injection | None] = {}
        for case in sorted(self.cases, key=lambda case: -case.strength):
            found[case.effect] = case if case.named else found.get(case.effect)
        return dict(sorted(found.items()))


def inject(
    trace: Trace,
    rig: Rig,
    names: Sequence[str] = (),
    strengths: Sequence[float] = (),
    seed: int = 0,
    workers: int | None = None,
    progress: Callable[[float], None] = lambda share: None,
) -> Injections:
    """Put known effects into a recording, one at a time, and diagnose it.

    Args:
        trace: the recording.
        rig: of its axis.
        names: of effects; all without.
        strengths: over the recording's residual; without, the least that is named is sought.
        seed: of their other parameters.
        workers: processes on this machine; None: one a core.
        progress: called with the share done.

    Raises:
        InputError: a name that cannot be put into a recording, or what `diagnose` raises of the recording as it is.
    """
    for name in names:
        if name not in INJECTABLE:
            found = f"found '{name}'{nearest(name, list(INJECTABLE))}"
            raise InputError("--effect", found, f"allowed: some of {', '.join(INJECTABLE)}")
    itself, asked = own(trace, rig), tuple(names) or INJECTABLE
    cases: dict[str, tuple[Injection, ...]] = {}
    failed: dict[str, str] = {}
    work = partial(tried, itself, tuple(strengths), seed)
    for place, outcome in each(work, asked, Limits(deadline=DEADLINE), workers):
        if isinstance(outcome, Failure):
            failed[asked[place]] = outcome.reason
        else:
            cases[asked[place]] = tuple(sorted(outcome, key=lambda case: case.strength))
        progress((len(cases) + len(failed)) / len(asked))
    ordered = tuple(case for name in asked for case in cases.get(name, ()))
    unable = tuple(name for name in asked if name in cases and not cases[name])
    return Injections(itself, ordered, not strengths, unable, failed)
