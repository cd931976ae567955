"""States of an axis made by hand, and what a recording says with other effects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from bench.baseline.observe import Observed
from bench.baseline.state import TORQUE_GAP, AxisEffect, DetectionLimits, RemainingGap, State
from bench.comparison.difference import Measured
from bench.effects.catalogue import catalogue

VALUES = {
    "moment_of_inertia": (1.5e-3, "kg*m**2", 3e-7),
    "viscous_friction_coefficient": (8e-4, "N*m*s/rad", 3e-6),
    "coulomb_friction_torque": (0.06, "N*m", 2e-4),
    TORQUE_GAP: (0.005, "N*m", 1e-4),
}
CONDITIONS = {
    "top_speed": (100.0, "rad/s"),
    "rms_speed": (60.0, "rad/s"),
    "rms_acceleration": (400.0, "rad/s**2"),
    "rms_effort": (0.7, "N*m"),
    "duration": (6.0, "s"),
    "sample_period": (1e-3, "s"),
    "cutoff": (66.0, "Hz"),
}


def state(changed: Mapping[str, float] | None = None, effects=(), verdict="nothing_missing", floor=0.005, **conditions):
    """A state; `changed`: factors on its quantities, further words on its conditions."""
    factors = changed or {}
    values = {name: Measured(v * factors.get(name, 1.0), unit, error) for name, (v, unit, error) in VALUES.items()}
    return State(
        source="recordings",
        names=True,
        quantities=values,
        effects=tuple(effects),
        verdict=verdict,
        gaps={"torque": RemainingGap(replace(values[TORQUE_GAP], std_error=0.0), Measured(floor, "N*m"))},
        shows=DetectionLimits(Measured(1e-3, "N*m"), Measured(2.5e-3, "N*m")),
        conditions={n: Measured(v * conditions.get(n, 1.0), unit, 0.0) for n, (v, unit) in CONDITIONS.items()},
        rig={"kind": "rotary", "motor.torque_constant": "0.8"},
        provenance={"version": "0.1.0"},
    )


def named(name: str, rms: float, ambiguous_with=(), **values: float) -> AxisEffect:
    """An effect that makes so much torque - N*m -, its quantities known to 1 %."""
    effect = catalogue()[name]
    quantities = {
        q.name: Measured(values[q.name], q.unit, 0.01 * abs(values[q.name]))
        for q in effect.quantities
        if q.name in values
    }
    shape = tuple(values.get(slot.quantity.name, 0.0) for slot in effect.shapes)
    return AxisEffect(effect, tuple(ambiguous_with), shape, torque=Measured(rms, "N*m", 1e-4), quantities=quantities)


@dataclass(frozen=True)
class GivenObserved(Observed):
    """A state that says what it is made to say with the effects of the baseline.

    Attributes:
        torques: of these effects, by name.
        factors: on its quantities.
    """

    fitted: object = "a fit"  # type: ignore[assignment]
    torques: Mapping[str, float] = field(default_factory=dict)
    factors: Mapping[str, float] = field(default_factory=dict)

    def under(self, others):
        found = {
            name: replace(one, value=one.value * self.factors.get(name, 1.0))
            for name, one in self.state.quantities.items()
        }
        effects = [
            replace(e, torque=Measured(self.torques[e.name], "N*m", 1e-4)) for e, _ in others if e.name in self.torques
        ]
        return replace(self.state, quantities=found, effects=tuple(effects))
