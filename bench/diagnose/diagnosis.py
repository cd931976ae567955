"""Diagnosis in five steps: gap, where, name, add, show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from bench.diagnose.added import axis_model, velocity_gap
from bench.diagnose.balance import EVERY, Balance
from bench.diagnose.candidates import EVENT
from bench.diagnose.decidable import one_way, require_decidable, require_positive, require_samples, untold
from bench.diagnose.fit import Fit, fit
from bench.diagnose.found import Gap, NamedEffect
from bench.diagnose.holdout import foreign, require_another
from bench.diagnose.hypothesis import CURRENT_LAG, DIRECTION, VELOCITY_LAG
from bench.diagnose.quantities import base_parameters, effect_parameters, uncertain
from bench.diagnose.search import OFFSET, REMAINDER, Step, search
from bench.diagnose.sensing import VelocityLag, unlagged, velocity_lag
from bench.diagnose.suspicious import suspicions
from bench.diagnose.voltage import VoltageLimit, voltage_limit
from bench.diagnose.where import Where, where
from bench.diagnose.workbench import Workbench
from bench.effects.catalogue import physics
from bench.effects.physics import Friction
from bench.identify.determined import require_significant
from bench.identify.estimate import Parameter
from bench.identify.load_inertia import load_inertia
from bench.identify.names import parameter_name, parameter_unit
from bench.identify.regressors import COULOMB, INERTIA, VISCOUS
from bench.plant.model_file import StoredModel
from bench.rig.rig import Rig
from bench.trace.trace import Trace

Progress = Callable[[float], None]

#: Names that no recording of torque and motion tells apart.
AMBIGUOUS = {
    OFFSET: (DIRECTION,),
    DIRECTION: (OFFSET,),
    CURRENT_LAG: (VELOCITY_LAG,),
    VELOCITY_LAG: (CURRENT_LAG,),
}


@dataclass(frozen=True)
class Diagnosis:
    """What is missing from the model of an axis, and the model with it."""

    verdict: str
    effects: list[NamedEffect]
    where: list[Where]
    unexplained_share: float
    unexplained_where: list[Where]
    parameters: dict[str, Parameter]
    torque: Gap
    velocity: Gap
    steps: list[tuple[str, float]]
    model: StoredModel | None
    balance: Balance
    warnings: list[str] = field(default_factory=list)


def diagnose(
    trace: Trace,
    rig: Rig,
    holdout: Trace | None = None,
    excluded: frozenset[str] = frozenset(),
    progress: Progress = lambda share: None,
) -> Diagnosis:
    """Find what is missing, name it, add it, and show the gap shrink.

    Args:
        trace: the recording.
        rig: of the axis.
        holdout: another recording of it, not used to fit.
        excluded: effects that are not tried.
        progress: called with the share done.

    Raises:
        UndeterminedError: the recording is too short, too slow or too quiet to decide.
        InputError: rig and recording do not fit together.
    """
    bench, other, lag = laid_out(trace, rig, holdout)
    steps = search(bench, rig.motor.rotor_inertia or 0.0, unsearched(trace, bench, excluded))
    progress(0.6)
    warnings = foreign(bench, steps[-1].fitted, other)
    fitted = proven(bench, steps[-1].fitted, None if warnings else other)
    _, unit = rig.net_effort(trace)
    found, parameters = named(bench, fitted, rig, unit, lag, voltage_limit(trace, rig, bench))
    effects = [effect for effect in found if effect.name not in excluded]
    require_significant(parameters[parameter_name(INERTIA, rig.linear)], rig.linear)
    require_positive(parameters[parameter_name(INERTIA, rig.linear)], trace.origin)
    balance = repeating(Balance.of(bench, fitted), other)
    progress(0.7)
    model, problem = axis_model(fitted, effects, parameters, rig)
    velocity, failed = velocity_gap(trace, holdout, rig, parameters, fitted, model)
    remains = fitted.chi > REMAINDER or len(effects) < len(found)
    return Diagnosis(
        verdict="unexplained_remainder" if remains else "explained" if effects else "nothing_missing",
        effects=effects,
        where=where(bench, steps[0].fitted, rig.linear, unit),
        unexplained_share=fitted.excess / max(float(np.sum(steps[0].fitted.residual ** 2)), 1e-300),
        unexplained_where=where(bench, fitted, rig.linear, unit)[:3] if remains else [],
        parameters=parameters,
        torque=torque_gap(bench, other, Balance.of(bench, steps[0].fitted), balance, fitted.floor, unit),
        velocity=velocity,
        steps=_shrinking(steps, fitted),
        model=model,
        balance=balance,
        warnings=[*suspicions(trace, rig, parameters), *untold(bench, rig.linear), *warnings, *problem, *failed],
    )


def unsearched(trace: Trace, bench: Workbench, excluded: frozenset[str]) -> frozenset[str]:
    """Effects not to be sought in the torque balance.

    Position and speed tell a lag of the speed themselves. In one direction an effect on dry friction is the same as one
    on torque: friction that varies with position and an unbalance, for instance.
    """
    lag = {VELOCITY_LAG} if {"position", "velocity"} <= set(trace.signals) else set()
    friction = {name for name, effect in physics().items() if isinstance(effect, Friction)} if one_way(bench) else set()
    return excluded | lag | friction


def laid_out(trace: Trace, rig: Rig, holdout: Trace | None) -> tuple[Workbench, Workbench | None, VelocityLag | None]:
    """Both recordings laid out, and the lag of the reported speed.

    A reported speed that lags its position is taken back to where it would have been without the lag.
    """
    require_samples(trace)
    if holdout is not None:
        require_samples(holdout)
        require_another(trace, holdout)
    bench = Workbench.of(trace, rig)
    require_decidable(trace, rig, bench)
    lag = velocity_lag(trace, bench)
    if lag is not None and bench.conditioning.source == "velocity":
        trace, holdout = unlagged(trace, lag), unlagged(holdout, lag) if holdout is not None else None
        bench = Workbench.of(trace, rig)
        require_decidable(trace, rig, bench)
    other = Workbench.of(holdout, rig, bench.conditioning.filter.width) if holdout is not None else None
    return bench, other, lag


def torque_gap(
    bench: Workbench, other: Workbench | None, before: Balance, after: Balance, floor: float, unit: str
) -> Gap:
    """RMS of measured less modelled torque without and with the effects, on both recordings."""
    holdout = (before.gap(other), after.gap(other)) if other is not None else None
    return Gap(unit, floor, (before.gap(bench), after.gap(bench)), holdout)


def repeating(balance: Balance, other: Workbench | None) -> Balance:
    """The balance with its events in every recording, where the holdout shows them at the same time of its own."""
    if other is None or EVENT not in balance.hypothesis.names:
        return balance
    everywhere = replace(balance, recording=EVERY)
    return everywhere if everywhere.gap(other) < balance.gap(other) else balance


def proven(bench: Workbench, fitted: Fit, other: Workbench | None) -> Fit:
    """Without the effects that make motion which was not fitted worse; an event belongs to its own recording."""
    if other is None:
        return fitted
    for index in range(len(fitted.hypothesis.effects) - 1, -1, -1):
        if fitted.hypothesis.effects[index].name == EVENT:
            continue
        less = fit(bench, fitted.hypothesis.without(index))
        if Balance.of(bench, fitted).gap(other) > Balance.of(bench, less).gap(other):
            fitted = less
    return fitted


def named(
    bench: Workbench, fitted: Fit, rig: Rig, unit: str, lag: VelocityLag | None, limit: VoltageLimit | None
) -> tuple[list[NamedEffect], dict[str, Parameter]]:
    """Effects with their quantities, and J, K_w, K_0 beside them."""
    numbers = uncertain(bench, fitted)
    columns = (INERTIA, VISCOUS, COULOMB)
    units = {parameter_name(c, rig.linear): parameter_unit(c, rig.linear, unit) for c in columns}
    parameters = base_parameters(fitted, numbers, units)
    parameters |= load_inertia(parameters, rig)
    tick = rig.drive.control_period if rig.drive is not None else 0.0
    told_apart = bench.conditioning.source == "position" or lag is not None
    effects = []
    for index, effect in enumerate(fitted.hypothesis.effects):
        less = fit(bench, fitted.hypothesis.without(index))
        evidence = {"residual_without": less.rms, "residual_with": fitted.rms, "noise_floor": fitted.floor}
        found = effect_parameters(fitted, numbers, index, rig.linear, unit, tick)
        ambiguous = AMBIGUOUS.get(effect.name, ())
        if effect.name == CURRENT_LAG and told_apart:
            ambiguous = ()
        effects.append(NamedEffect(effect.name, found, ambiguous, evidence))
    if lag is not None:
        reach = 1.96 * lag.std_error + 0.5 * tick
        value = Parameter(lag.time_constant, "s", reach / 1.96, (lag.time_constant - reach, lag.time_constant + reach))
        evidence = {"speed_against_position_before": lag.before, "speed_against_position_after": lag.after}
        effects.append(NamedEffect(VELOCITY_LAG, {"time_constant": value}, (), evidence))
    if limit is not None:
        reach = 1.96 * limit.std_error
        value = Parameter(limit.voltage, "V", limit.std_error, (limit.voltage - reach, limit.voltage + reach))
        evidence = {"samples_at_the_limit": float(limit.samples), "speed_behind": limit.behind}
        effects.append(NamedEffect("voltage_limit", {"voltage": value}, (), evidence))
    return effects, parameters


def _shrinking(steps: list[Step], final: Fit) -> list[tuple[str, float]]:
    """Torque gap after each addition; the last one as it was kept."""
    shown = [
        (step.fitted.hypothesis.names[-1] if step.fitted.hypothesis.names else "", step.fitted.rms) for step in steps
    ]
    if final.hypothesis != steps[-1].fitted.hypothesis:
        shown.append((final.hypothesis.names[-1] if final.hypothesis.names else "", final.rms))
    return shown[1:]
