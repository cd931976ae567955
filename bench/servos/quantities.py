"""From fitted ratios to a servo's parameters: which have a value of their own, and which only appear together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from bench.axis_kind import ARMATURE, COULOMB, OFFSET, VISCOUS, AxisKind
from bench.names import words
from bench.parameter import Parameter
from bench.servos.fit import LONGEST_DEAD_TIME, ServoFit
from bench.servos.joint import JointModel
from bench.servos.law import ERROR, RATE, Law

Values = Mapping[str, float]
#: Gains that a law gives, its coefficients, and their unit of time.
BY_LAW = ("kp", ERROR, ""), ("kv", RATE, "*s")
#: Which of two dampings is kv is determined where the interval of kv is at most this share of both together.
SEPARATED = 0.35


@dataclass(frozen=True)
class Agreement:
    """A value that a rig states, next to what was found of it, and whether both agree."""

    value: float
    found: Parameter
    agrees: bool


@dataclass
class Quantities:
    """Parameters of a servo.

    Attributes:
        parameters: those that are determined, by name.
        inseparable: combinations, where a parameter appears in no other way.
        advice: what would separate them, in sentences.
        refused: parameters that are not determined, and why.
        effects: what the servo has in addition, with its size.
        actuator: attributes of MuJoCo's `<position>` and of its joint; empty where torques have no scale.
        stated: what a rig states of a drive.
    """

    parameters: dict[str, Parameter] = field(default_factory=dict)
    inseparable: dict[str, Parameter] = field(default_factory=dict)
    advice: list[str] = field(default_factory=list)
    refused: dict[str, str] = field(default_factory=dict)
    effects: dict[str, dict[str, Parameter]] = field(default_factory=dict)
    actuator: dict[str, float] = field(default_factory=dict)
    stated: dict[str, Agreement] = field(default_factory=dict)


def quantities(
    fit: ServoFit, inertia: Callable[[Values], float] | None, kind: AxisKind, model: JointModel | None
) -> Quantities:
    """All that follows from a fit.

    Args:
        inertia: of its values - kg*m**2 (kg); None where torques have no scale.
        model: of the joint, where an MJCF is known.
    """
    found, scaled = Quantities(), inertia is not None
    of_inertia = ARMATURE if model is not None else kind.inertia
    scale: Callable[[Values], float] = inertia if inertia is not None else lambda _: 1.0
    length, effort = kind.length_unit, kind.effort_unit
    coulomb, limit = kind.parameter(COULOMB), "force_limit"

    def add(name: str, of: Callable[[Values], float], unit: str, per_inertia: str) -> None:
        """A parameter, or with torques of no scale its ratio to the inertia."""
        if scaled:
            found.parameters[name] = fit.parameter(lambda values: scale(values) * of(values), unit)
        else:
            found.inseparable[f"{name}/{kind.inertia}"] = fit.parameter(of, per_inertia)

    add("kp", lambda values: values["stiffness"], f"{effort}/{length}", "1/s**2")
    found.parameters["dead_time"] = fit.parameter(lambda values: values["dead_time"], "s")
    _damping(found, fit, scale, scaled, kind, model)
    add(coulomb, lambda values: values["friction"], effort, f"{length}/s**2")
    if abs(fit.values["offset"]) > 0.0:
        add(kind.parameter(OFFSET), lambda values: values["offset"], effort, f"{length}/s**2")
    if "limit" in fit.names:
        add(limit, lambda values: values["limit"], effort, f"{length}/s**2")
    else:
        least = fit.demand * scale(fit.values)
        unit = effort if scaled else f"{length}/s**2 times the {words(kind.inertia)}"
        found.refused[limit] = f"not reached; it is at least {least:.3g} {unit}"
        found.advice.append("force_limit: larger or quicker steps of the goal, until the motion no longer speeds up.")
    if "speed_limit" in fit.names:
        found.parameters["speed_limit"] = fit.parameter(lambda values: values["speed_limit"], f"{length}/s")
    measured = fit.parameter(scale, kind.inertia_unit)
    if scaled and measured.half_width > 0.0:  # a stated one has none
        less = 0.0 if model is None else model.link_inertia
        low, high = (end - less for end in measured.ci95)
        found.parameters[of_inertia] = Parameter(measured.value - less, measured.unit, measured.std_error, (low, high))
    elif not scaled:
        known = _unknown_scale(model, kind)
        found.advice.append(f"kp, {coulomb} and {kind.inertia}: {known}")
    _effects(found, fit, scale, scaled, kind)
    _actuator(found, fit, scale, scaled, model)
    return found


def with_law(found: Quantities, law: Law, kind: AxisKind, link: float) -> None:
    """Gains of a servo whose torque is recorded: by its law, which also gives the scale; the other damping is K_w.

    `link`: inertia that is not in the armature - kg*m**2 (kg).
    """
    viscous, per = kind.parameter(VISCOUS), f"{kind.effort_unit}{{}}/{kind.length_unit}"
    gains = {name: law.parameter(lambda v, of=of: v[of], per.format(unit)) for name, of, unit in BY_LAW}
    kp, kv = gains.values()
    share = kp.half_width / kp.value
    both = found.inseparable.pop(f"kv + {viscous}", None)
    for name, one in found.parameters.items():
        if name not in ("dead_time", "speed_limit"):
            found.parameters[name] = one.widened(share * (one.value + link * (name == ARMATURE)))
    if both is not None:
        passive = both.at(both.value - kv.value, positive=False)
        found.parameters[viscous] = passive.widened(kv.half_width, share * both.value)
        found.refused.pop(viscous, None)
        found.advice = [one for one in found.advice if not one.startswith("kv and ")]
    found.parameters |= gains
    if law.limit is not None:
        found.parameters["force_limit"] = replace(law.limit, unit=kind.effort_unit)
        found.refused.pop("force_limit", None)
    if found.actuator:
        damping = max(found.parameters[viscous].value, 0.0)
        found.actuator |= {"kp": kp.value, "kv": kv.value, "damping": damping}


def _unknown_scale(model: JointModel | None, kind: AxisKind) -> str:
    """What would give the scale of torques, in a sentence."""
    if model is None:
        own = "[motor] rotor_inertia and [load] moment_of_inertia" if kind.turns else "[motor] moving_mass"
        known = f"state the inertia (an MJCF, or {own} in the rig)"
        return f"{known}, or move a known mass against gravity ([load] eccentric_mass)."
    known = "the MJCF states no armature"
    if model.armature:
        known = f"the link's weight contradicts the armature of {model.armature:.3g} {kind.inertia_unit} in the MJCF"
    return f"{known}: state that of motor and gear there, or let the goals turn the link further against gravity."


def _damping(
    found: Quantities,
    fit: ServoFit,
    scale: Callable[[Values], float],
    scaled: bool,
    kind: AxisKind,
    model: JointModel | None,
) -> None:
    """kv and K_w: separate where the limit was reached often enough, else together, or kv less what an MJCF has."""
    unit, viscous = f"{kind.effort_unit}*s/{kind.length_unit}" if scaled else "1/s", kind.parameter(VISCOUS)
    both = fit.parameter(lambda values: scale(values) * (values["damping"] + values["drive_damping"]), unit)
    drive = fit.parameter(lambda values: scale(values) * values["drive_damping"], unit)
    apart = "limit" in fit.names and 0.0 < drive.half_width < SEPARATED * both.value
    per = "" if scaled else f"/{kind.inertia}"
    if apart:
        passive = fit.parameter(lambda values: scale(values) * values["damping"], unit)
        into = found.parameters if scaled else found.inseparable
        into |= {f"kv{per}": drive, f"{viscous}{per}": passive}
        return
    found.inseparable[f"(kv + {viscous}){per}" if per else f"kv + {viscous}"] = both
    if model is not None and scaled:
        known = model.damping
        found.parameters["kv"] = fit.parameter(
            lambda values: scale(values) * (values["damping"] + values["drive_damping"]) - known, unit
        )
        found.refused[viscous] = f"assumed to be {known:.3g} {unit}, the joint's damping in the MJCF"
    found.advice.append(
        f"kv and {viscous}: steps of the goal that keep the controller at its limit for a while; "
        f"there {viscous} brakes and kv does not."
    )


def _effects(found: Quantities, fit: ServoFit, scale: Callable[[Values], float], scaled: bool, kind: AxisKind) -> None:
    """What the servo has in addition to gains, delay, limits and friction."""
    per, length = kind.effort_unit if scaled else f"{kind.length_unit}/s**2", kind.length_unit
    for name, quantity in (("dead_band", "half_width"), ("play", "gap")):
        if name in fit.names:
            found.effects[name] = {quantity: fit.parameter(lambda values, name=name: values[name], length)}
    if "sine" in fit.names:
        size = fit.parameter(lambda values: scale(values) * np.hypot(values["sine"], values["cosine"]), per)
        angle = fit.parameter(lambda values: float(np.arctan2(values["cosine"], -values["sine"])), "rad")
        found.effects["gravity"] = {"amplitude": size, "hanging_position": angle}
    if "feedforward" in fit.names:
        unit = f"{kind.effort_unit}*s/{length}" if scaled else "1/s"
        gain = fit.parameter(lambda values: scale(values) * values["feedforward"], unit)
        found.effects["velocity_feedforward"] = {"gain": gain}


def _actuator(
    found: Quantities, fit: ServoFit, scale: Callable[[Values], float], scaled: bool, model: JointModel | None
) -> None:
    """What goes into MuJoCo: with separated dampings each in its place, else what the MJCF lacks of both as kv."""
    if not scaled:
        return
    j, values = scale(fit.values), fit.values
    both = j * (values["damping"] + values["drive_damping"])
    passive = both - found.parameters["kv"].value if "kv" in found.parameters else 0.0
    found.actuator = {
        "kp": j * values["stiffness"],
        "kv": max(both - passive, 0.0),
        "delay": values["dead_time"],
        "damping": passive,
        "frictionloss": j * values["friction"],
        "armature": max(j - (model.link_inertia if model is not None else 0.0), 0.0),
    }
    if "limit" in fit.names:
        found.actuator["forcerange"] = j * values["limit"]


def warnings_of(fit: ServoFit, floor: float, noise: bool, period: float) -> list[str]:
    """What a user should know before relying on a fit."""
    found = []
    if fit.values["dead_time"] > 0.98 * LONGEST_DEAD_TIME:
        found.append(
            f"dead_time is at its bound of {LONGEST_DEAD_TIME:g} s: check that goal and position share a clock"
        )
    if not noise:
        found.append(
            f"the residual is {fit.error / floor:.2g} times the noise: the servo model lacks an effect, "
            "the gains may contain part of it, and the intervals do not cover that"
        )
    if np.sqrt(fit.values["stiffness"]) * period > 0.6:
        found.append(
            f"the servo is quick for a log every {1e3 * period:.3g} ms: how the goal moves between two samples matters"
        )
    return found
