"""The state that recordings of an axis tell, by `identify` alone or by `diagnose` too."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.balance.fit import Fit, fit
from bench.balance.hum import with_hum
from bench.balance.hypothesis import Term
from bench.balance.parameter import Parameter
from bench.balance.quantities import uncertain
from bench.balance.shapes import shaped
from bench.check.conditions import conditions
from bench.check.measured import Measured
from bench.check.same_rig import rig_values
from bench.check.state import TORQUE_GAP, VELOCITY_GAP, Gap, NamedHere, Shows, State
from bench.checks.gate import passed
from bench.diagnose.diagnosis import POLICY, Diagnosis, diagnose
from bench.diagnose.found import NamedEffect
from bench.diagnose.recordings import Recordings
from bench.identify.estimate import Alone
from bench.identify.regression import identify
from bench.rig.rig import Rig
from bench.trace.trace import Trace

Progress = Callable[[float], None]
#: Effects that another state has, and which of one's own each of them is.
Others = Sequence[tuple[NamedHere, NamedHere | None]]


@dataclass(frozen=True)
class Observed:
    """A state, and what it was read from.

    Attributes:
        state: of the axis.
        recordings: laid out; None without names.
        fitted: the torque balance with the effects that were found; None without names.
    """

    state: State
    recordings: Recordings | None = None
    fitted: Fit | None = None

    def under(self, others: Others) -> tuple[dict[str, Measured], list[Measured | None]]:
        """Quantities with the effects of another state in the place of one's own, and the torque of each of them.

        A name that comes or goes moves J, K_w and K_0 with it: what is the same axis has to be so under both.

        Args:
            others: effects of the other state. Those which are not one's own keep the shape they had there to begin
                with; those which the torque balance does not hold are left out.
        """
        recordings, own = self.recordings, self.fitted
        assert recordings is not None and own is not None
        held = [pair for pair in others if pair[0].shape is not None]
        hypothesis = own.hypothesis.with_terms(_term(effect, mine, own, self.state) for effect, mine in held)
        fitted = fit(recordings.rows, hypothesis)
        for index, (_, mine) in enumerate(held):
            if mine is None:
                fitted = shaped(fitted.rows, fitted.hypothesis, index)
        base = uncertain(fitted).base(recordings.base_units)
        torques = iter([_torque(fitted, index, recordings.unit) for index in range(len(held))])
        found = [next(torques) if effect.shape is not None else None for effect, _ in others]
        return {name: Measured.of(one) for name, one in base.items()} | {TORQUE_GAP: _torque_gap(fitted)}, found


def identified(traces: Sequence[Trace], rig: Rig) -> Observed:
    """What `identify` tells of recordings: parameters, and how far the residual stands above the noise.

    Raises:
        UndeterminedError: they do not determine a parameter.
        InputError: as `identify`.
    """
    traces = [passed(trace, rig).trace for trace in traces]
    found = identify(traces, rig)
    kind, left = rig.axis_kind, found.residual
    names = [kind.parameter(term) for term in (INERTIA, VISCOUS, COULOMB)]
    ratio = left.rms / left.noise_floor
    rows = found.samples_used * (traces[0].sample_period * found.cutoff)
    state = State(
        source="recordings",
        names=False,
        quantities=_parameters(names, found.parameters, found.recordings)
        | {TORQUE_GAP: Measured(ratio, "dimensionless", ratio / np.sqrt(max(rows, 1.0)))},
        gaps={"torque": Gap(left.rms, left.noise_floor, left.unit)},
        conditions=conditions(traces, rig, found.cutoff),
        rig=rig_values(rig),
    )
    return Observed(state)


def diagnosed(traces: Sequence[Trace], rig: Rig, progress: Progress = lambda share: None) -> Observed:
    """What `diagnose` tells of recordings: parameters beside the effects that are named, gaps and verdict.

    Raises:
        UndeterminedError, InputError: as `diagnose`.
    """
    found = diagnose(traces, rig, progress=progress)
    traces = [passed(trace, rig).trace for trace in traces]
    recordings = Recordings.of(traces, rig, None)
    fitted = with_hum(fit(recordings.rows, found.balance.hypothesis))
    count = len(fitted.terms)
    effects = [_named(effect, fitted, index, recordings.unit) for index, effect in enumerate(found.effects[:count])]
    effects += [NamedHere(e.effect, _measured(e.parameters)) for e in found.effects[count:]]
    cutoff = recordings.rows.conditioning.filter.cutoff
    state = State(
        source="recordings",
        names=True,
        quantities=_parameters(recordings.base_units, found.parameters, found.recordings) | _gaps(found, fitted),
        effects=tuple(effects),
        verdict=found.verdict,
        gaps={
            name: Gap(gap.identify[1], gap.noise_floor, gap.unit)
            for name, gap in (("torque", found.torque), ("velocity", found.velocity))
            if gap.identify is not None
        },
        shows=_shows(fitted),
        conditions=conditions(traces, rig, cutoff),
        rig=rig_values(rig),
    )
    return Observed(state, recordings, fitted)


def _parameters(
    names: Sequence[str] | Mapping[str, str], found: Mapping[str, Parameter], recordings: Sequence[Alone]
) -> dict[str, Measured]:
    alone = {name: [one.parameters[name] for one in recordings if name in one.parameters] for name in names}
    return {name: Measured.of(found[name], alone[name]) for name in names if name in found}


def _measured(parameters: Mapping[str, Parameter]) -> dict[str, Measured]:
    return {name: Measured.of(one) for name, one in parameters.items()}


def _named(found: NamedEffect, fitted: Fit, index: int, unit: str) -> NamedHere:
    term, torque = fitted.terms[index], _torque(fitted, index, unit)
    return NamedHere(
        effect=found.effect,
        quantities=_measured(found.parameters),
        shape=term.shape,
        on_load=term.load is not None,
        torque=torque,
        ambiguous_with=found.ambiguous_with,
        gain=(torque.value / torque.std_error) ** 2,
    )


def _torque(fitted: Fit, index: int, unit: str) -> Measured:
    """RMS torque of a term that the rest of the model does not explain in its place.

    Its square is what the term saves of the mean squared residual; its error that of an amplitude along one direction
    of the rows, of which as many are independent as the filter leaves.
    """
    less = fit(fitted.rows, fitted.hypothesis.without(index))
    saved = max(less.squares - fitted.squares, 0.0) / fitted.count
    error = fitted.floor * np.sqrt(fitted.rows.correlation / fitted.count)
    return Measured(float(np.sqrt(saved)), unit, float(error))


def _torque_gap(fitted: Fit) -> Measured:
    """Residual over noise floor; both are read from as many independent rows as the filter leaves."""
    independent = fitted.count / fitted.rows.correlation
    return Measured(fitted.chi, "dimensionless", float(fitted.chi / np.sqrt(independent)))


def _shows(fitted: Fit) -> Shows:
    """What is significant in a recording, and what its residual may hide: up to `Remainder.chi` it counts as noise."""
    significant = POLICY.significant.threshold(fitted, 1) / fitted.count
    hidden = max(fitted.chi, POLICY.remainder.chi) ** 2 - 1.0
    return Shows(float(np.sqrt(significant)), float(fitted.floor * np.sqrt(hidden)))


def _gaps(found: Diagnosis, fitted: Fit) -> dict[str, Measured]:
    gaps = {TORQUE_GAP: _torque_gap(fitted)}
    velocity = found.velocity
    if velocity.identify is not None and velocity.noise_floor > 0.0:
        gaps[VELOCITY_GAP] = Measured(velocity.identify[1] / velocity.noise_floor, "dimensionless", 0.0)
    return gaps


def _term(effect: NamedHere, mine: NamedHere | None, own: Fit, state: State) -> Term:
    """The term of an effect: as this recording has it, else of the shape it had in the other."""
    if mine is not None:
        return own.terms[[one for one in state.effects if one.shape is not None].index(mine)]
    return Term(effect.effect, effect.shape or (), load=() if effect.on_load else None)
