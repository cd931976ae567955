"""Voltage limit: the drive runs out of voltage at speed, and current falls behind its demand.

    L*dI/dt = U - R*I - K_e*omega,  |U| <= U_max

U_max - voltage - V; L, R, K_e - inductance - H, resistance - ohm, back-EMF constant - V*s/rad (V*s/m) of the winding.
The current loop brings the current to its demand as fast as the voltage allows, and what flows is what is reported.
Source: W. Leonhard, Control of Electrical Drives (current control under limited voltage).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bench.effects.physics import Array, Axis, Electronics, Number, Values, Winding
from bench.errors import InputError
from bench.units import Quantity

#: Time constant of a winding without inductance - s: none, but for a division.
SHORTEST = 1e-12


class VoltageLimit(Electronics):
    """See the module."""

    name = "voltage_limit"
    summary = "the drive runs out of voltage at speed"
    quantities = (Quantity("voltage", "U_max", "V", lower=0.0),)

    def null(self, axis: Axis) -> Mapping[str, Number]:
        """Where the effect is absent: any voltage."""
        return {"voltage": np.inf}

    def flowing(
        self, values: Values, axis: Axis, velocity: Array, demand: Array, before: Array, step: float
    ) -> tuple[Array, Array]:
        """Full voltage until the current is what is demanded, then what holds it there, if the limit allows."""
        winding = _winding(axis)
        constant = winding.torque_constant
        tau = np.maximum(winding.inductance / winding.resistance, SHORTEST)
        wanted, start = demand / constant, before / constant
        emf = winding.back_emf_constant * velocity
        limit = values["voltage"]
        holds = np.abs(emf + winding.resistance * wanted) <= limit
        full = np.where(
            holds, np.copysign(limit, wanted - start), np.copysign(limit, emf + winding.resistance * wanted)
        )
        settled = (full - emf) / winding.resistance
        until = np.where(holds, _time_to(wanted, start, settled, tau, step), step)
        decay = np.exp(-until / tau)
        end = np.where(holds & (until < step), wanted, settled + (start - settled) * decay)
        area = settled * until + (start - settled) * tau * (1.0 - decay) + wanted * (step - until)
        return constant * area / step, constant * end


def _time_to(wanted: Array, start: Array, settled: Array, tau: Number, step: float) -> Array:
    """Time in which a current that tends to `settled` goes from `start` to `wanted`, at most a step - s."""
    ratio = (start - settled) / np.where(wanted == settled, np.inf, wanted - settled)
    return np.minimum(tau * np.log(np.maximum(ratio, 1.0)), step)


def _winding(axis: Axis) -> Winding:
    if axis.winding is None:
        raise InputError(
            "voltage_limit",
            "found a motor without resistance, inductance or constant",
            "allowed: a rig whose [motor] states resistance, inductance, back_emf_constant and torque_constant",
        )
    return axis.winding


EFFECT = VoltageLimit()
