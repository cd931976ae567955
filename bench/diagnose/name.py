"""Name what is missing: in the torque balance by search, elsewhere by what the recording says of drive and sensor."""

from __future__ import annotations

from dataclasses import dataclass

from bench.diagnose.chain import Grown
from bench.diagnose.decidable import one_way
from bench.diagnose.doubt import doubted
from bench.diagnose.fit import fit
from bench.diagnose.found import NamedEffect
from bench.diagnose.hypothesis import CURRENT_LAG, DIRECTION, VELOCITY_LAG
from bench.diagnose.quantities import base_parameters, effect_parameters, uncertain
from bench.diagnose.recordings import Recordings
from bench.diagnose.search import OFFSET, Step, search
from bench.diagnose.sensing import VelocityLag
from bench.diagnose.voltage import VOLTAGE_LIMIT, VoltageLimit, voltage_limit
from bench.effects.catalogue import physics
from bench.effects.physics import Friction
from bench.effects.present import Present
from bench.identify.estimate import Parameter
from bench.identify.load_inertia import load_inertia
from bench.identify.regressors import COULOMB, INERTIA, VISCOUS

#: Names that no recording of torque and motion tells apart.
AMBIGUOUS = {
    OFFSET: (DIRECTION,),
    DIRECTION: (OFFSET,),
    CURRENT_LAG: (VELOCITY_LAG,),
    VELOCITY_LAG: (CURRENT_LAG,),
}


@dataclass(frozen=True)
class Suspects:
    """What was named.

    Attributes:
        steps: of the search; the last one's fit has the effects of the torque balance.
        lag: of the reported speed, if it is to be named.
        limit: of the voltage, if it is to be named.
        withheld: whether something was found whose name was not to be tried.
    """

    steps: list[Step]
    lag: VelocityLag | None
    limit: VoltageLimit | None
    withheld: bool

    @property
    def beside(self) -> tuple[Present, ...]:
        """Effects that the torque balance does not hold."""
        found = []
        if self.lag is not None:
            found.append(Present.of(VELOCITY_LAG, {"time_constant": self.lag.time_constant}))
        if self.limit is not None:
            found.append(Present.of(VOLTAGE_LIMIT, {"voltage": self.limit.voltage}))
        return tuple(found)


def name(recordings: Recordings, excluded: frozenset[str]) -> Suspects:
    """Suspects of a recording.

    Args:
        recordings: laid out.
        excluded: effects that are not tried.
    """
    bench, untried = recordings.bench, unsearched(recordings, excluded)
    steps = search(bench, recordings.rig.motor.rotor_inertia or 0.0, untried)
    steps = doubted(bench, recordings.other, steps, untried)
    lag, limit = recordings.lag, voltage_limit(recordings.trace, recordings.rig, recordings.bench)
    withheld = [lag is not None and VELOCITY_LAG in excluded, limit is not None and VOLTAGE_LIMIT in excluded]
    return Suspects(steps, None if withheld[0] else lag, None if withheld[1] else limit, any(withheld))


def unsearched(recordings: Recordings, excluded: frozenset[str]) -> frozenset[str]:
    """Effects not to be sought in the torque balance.

    Position and speed tell a lag of the speed themselves. In one direction an effect on dry friction is the same as one
    on torque: friction that varies with position and an unbalance, for instance.
    """
    lag = {VELOCITY_LAG} if {"position", "velocity"} <= set(recordings.trace.signals) else set()
    rubs = {name for name, effect in physics().items() if isinstance(effect, Friction)}
    return excluded | lag | (rubs if one_way(recordings.bench) else set())


def named(recordings: Recordings, grown: Grown, suspects: Suspects) -> tuple[list[NamedEffect], dict[str, Parameter]]:
    """Effects of a grown model with their quantities, and J, K_w, K_0 beside them."""
    bench, rig, unit, fitted = recordings.bench, recordings.rig, recordings.unit, grown.fitted
    beside = {present.name for present in grown.beside}
    lag = suspects.lag if VELOCITY_LAG in beside else None
    limit = suspects.limit if VOLTAGE_LIMIT in beside else None
    numbers = uncertain(bench, fitted)
    columns = (INERTIA, VISCOUS, COULOMB)
    units = {rig.axis_kind.parameter(c): rig.axis_kind.parameter_unit(c, unit) for c in columns}
    parameters = base_parameters(fitted, numbers, units)
    parameters |= load_inertia(parameters, rig)
    tick = rig.drive.control_period if rig.drive is not None else 0.0
    told_apart = bench.conditioning.source == "position" or recordings.lag is not None
    effects = []
    for index, effect in enumerate(fitted.hypothesis.effects):
        less = fit(bench, fitted.hypothesis.without(index))
        evidence = {"residual_without": less.rms, "residual_with": fitted.rms, "noise_floor": fitted.floor}
        found = effect_parameters(fitted, numbers, index, rig.axis_kind, unit)
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
        effects.append(NamedEffect(VOLTAGE_LIMIT, {"voltage": value}, (), evidence))
    return effects, parameters
