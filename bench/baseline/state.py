"""The state of an axis, from recordings or from a model: everything that is compared, and the file that keeps it.

The file is TOML for version control, readable in a diff:

schema = "bench.baseline/1"
source = "recordings"
names = true
verdict = "explained"
[provenance]
version = "0.1.0"
[quantities.moment_of_inertia]
value = "0.00131 kg*m**2"
std_error = "1.2e-06 kg*m**2"
recordings = 1
spread = "not determined by fewer than two recordings"
[[effects]]
name = "cogging_torque"
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tomli_w
from pydantic import BaseModel, BeforeValidator, Field, PlainSerializer, PlainValidator, TypeAdapter, ValidationError

from bench.axis_kind import AxisKind, axis_kind
from bench.comparison.difference import Measured
from bench.effects.effect import Effect
from bench.effects.present import named
from bench.errors import InputError
from bench.files import read_bytes, write_text
from bench.structured import read_toml
from bench.validated import input_error, refused

#: Quantities that are not parameters: gaps over their noise floors.
GAPS = TORQUE_GAP, VELOCITY_GAP = "torque_gap", "velocity_gap"
#: Conditions that turn a torque into the change of a parameter that it makes.
MOTION = "rms_speed", "rms_acceleration", "rms_effort"
#: Share by which the harmonics of two waves may differ and still be one: the pitch of a linear axis is fitted.
SAME_WAVE = 0.01
#: Number of instants at which the torque of a model's run is kept.
INSTANTS = 24

SCHEMA = "bench.baseline/1"
HEAD = "# The baseline of bench check; bench check --update writes it again.\n"
#: Written instead of an unknown spread; its end is what is read, as files of earlier versions have other words before.
FEW = "by fewer than two recordings"
NO_SPREAD = f"not determined {FEW}"
_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?: (.+))?")
_ALLOWED = "allowed: as bench check --update wrote it"
#: Magnitudes of what is known of an axis, unless it is zero: their fourth powers, which comparisons take, are numbers.
LEAST, MOST = 1e-60, 1e60


def _plain(value: object) -> float:
    """A number as one of an axis can be."""
    if isinstance(value, bool) or not isinstance(value, float | int):
        raise refused(f"found {value!r}", "allowed: a number")
    if value != 0.0 and not LEAST <= abs(value) <= MOST:
        raise refused(f"found {value!r}", "allowed: a number as one of an axis can be")
    return float(value)


def _read(text: object) -> Measured:
    """An exact quantity: a number with its unit."""
    match = _NUMBER.fullmatch(text) if isinstance(text, str) else None
    if match is None:
        raise refused(f"found {text!r}", "allowed: a number and its unit")
    return Measured(_plain(float(match[1])), match[2] or "dimensionless")


def _text(value: float, unit: str) -> str:
    """A number in as many digits as any comparison needs, with its unit."""
    return f"{value:.9g} {unit}" if unit != "dimensionless" else f"{value:.9g}"


#: A number, and an exact quantity with its unit, in the file.
Plain = Annotated[float, BeforeValidator(_plain)]
Exact = Annotated[Measured, PlainValidator(_read), PlainSerializer(lambda found: _text(found.value, found.unit))]


class _Written(BaseModel):
    """A measured quantity in the file; an exact one has only a value."""

    value: Exact
    std_error: Exact | None = None
    degrees: Annotated[float, BeforeValidator(lambda one: one if one == math.inf else _plain(one))] = math.inf
    recordings: Annotated[int, Field(strict=True)] = 1
    spread: Annotated[Measured | None, PlainValidator(lambda one: None if str(one).endswith(FEW) else _read(one))] = (
        None
    )
    each: tuple[Plain, ...] = ()


def _measured(table: object) -> Measured:
    one = _Written.model_validate(table)
    error, spread = (found and found.value for found in (one.std_error, one.spread))
    if not (one.degrees > 0.0 and one.recordings > 0 and (error or 0.0) >= 0.0 and (spread or 0.0) >= 0.0):
        raise refused("found an error or a count below zero", _ALLOWED)
    return Measured(one.value.value, one.value.unit, error or 0.0, one.degrees, one.recordings, spread, one.each)


def _table(found: Measured) -> dict[str, Any]:
    table = {"value": _text(found.value, found.unit)}
    if not found.std_error:
        return table
    degrees = {"degrees": round(found.degrees, 1)} if math.isfinite(found.degrees) else {}
    spread = NO_SPREAD if found.spread is None else _text(found.spread, found.unit)
    error = _text(found.std_error, found.unit)
    each = {"each": [float(f"{value:.9g}") for value in found.each]} if found.each else {}
    return {**table, "std_error": error, **degrees, "recordings": found.recordings, "spread": spread, **each}


Quantity = Annotated[Measured, PlainValidator(_measured), PlainSerializer(_table)]


def _effect(name: object) -> Effect:
    try:
        return named(str(name))
    except InputError as error:
        raise refused(error.found, error.allowed) from error


@dataclass(frozen=True)
class AxisEffect:
    """An effect of a state.

    Attributes:
        effect: what it is.
        ambiguous_with: names of effects that the recording cannot distinguish from it.
        shape: in the torque balance, in the effect's order; None for one read directly from signals.
        on_load: whether it acts on the load behind a coupling.
        torque: RMS torque that the rest of the model cannot explain - N*m (N); None outside the torque balance.
        gain: reduction of the squared residual over that of noise; None outside the torque balance.
        quantities: of it.
    """

    effect: Annotated[Effect, PlainValidator(_effect), PlainSerializer(lambda one: one.name), Field(alias="name")]
    ambiguous_with: tuple[str, ...] = ()
    shape: tuple[Plain, ...] | None = None
    on_load: bool = False
    torque: Quantity | None = None
    gain: Plain | None = None
    quantities: Mapping[str, Quantity] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Of the effect."""
        return self.effect.name

    @property
    def label(self) -> str:
        """Name, with the harmonic where an axis may have several."""
        waves = [f"{slot.quantity.name} {value:.4g}" for slot, value in self.whole]
        return f"{self.name} ({', '.join(waves)})" if waves else self.name

    @property
    def whole(self) -> list[tuple[Any, float]]:
        """Integer quantities of its shape, with their values."""
        return [pair for pair in zip(self.effect.shapes, self.shape or (), strict=False) if pair[0].whole]

    def same(self, other: AxisEffect) -> bool:
        """Whether it is the same effect of the same harmonic."""
        pairs = zip(self.whole, other.whole, strict=False)
        alike = all(bool(np.isclose(a[1], b[1], rtol=SAME_WAVE, atol=0.0)) for a, b in pairs)
        return self.effect is other.effect and alike

    def indistinguishable_from(self, other: AxisEffect) -> bool:
        """Whether a recording cannot distinguish the two."""
        return self.name in other.ambiguous_with or other.name in self.ambiguous_with

    @property
    def compared(self) -> dict[str, Measured]:
        """Quantities that are compared: no angles and instants, whose zero is arbitrary, and no integers."""
        whole = {slot.quantity.name for slot, _ in self.whole}
        kept = [q.name for q in self.effect.quantities if not (q.angle or q.instant or q.name in whole)]
        known = {name: self.quantities[name] for name in kept if name in self.quantities}
        return {name: found for name, found in known.items() if math.isfinite(found.std_error)}


@dataclass(frozen=True)
class RemainingGap:
    """RMS of a gap that remains with the effects found, and what noise causes of it."""

    after: Exact
    noise_floor: Exact


@dataclass(frozen=True)
class DetectionLimits:
    """Smallest effects that a recording would have shown.

    Attributes:
        torque: RMS torque from which on an effect with one parameter is significant.
        residual: RMS torque that the residual may hide.
    """

    torque: Exact
    residual: Annotated[Exact, Field(alias="left")]


@dataclass(frozen=True)
class Response:
    """A run of a model: the drive's torque at INSTANTS of it - N*m (N).

    Drive and speeds are laid out for an inertia - kg*m**2 (kg) - and a largest acceleration - rad/s**2 (m/s**2).
    """

    inertia: Annotated[Plain, Field(gt=0.0)]
    acceleration: Annotated[Plain, Field(gt=0.0)]
    torque: Annotated[tuple[Plain, ...], Field(min_length=INSTANTS, max_length=INSTANTS)]


@dataclass(frozen=True)
class State:
    """The state of an axis.

    Attributes:
        source: `recordings` or `model`.
        names: whether effects were searched for.
        quantities: parameters and gaps by name.
        effects: in the order in which they were added.
        verdict: of the diagnosis; empty without names.
        gaps: by `torque` and `velocity`.
        shows: smallest effects that the recording would have shown; None without names.
        conditions: motion, sampling and cut-off by name, SI (`bench.baseline.observe`).
        rig: values that identification reads of the rig, by key (`bench.baseline.observe`).
        provenance: version, digests, options.
        response: of a model; None of recordings.
    """

    source: str
    names: Annotated[bool, Field(strict=True)]
    quantities: Mapping[str, Quantity]
    effects: tuple[AxisEffect, ...] = ()
    verdict: str = ""
    gaps: Annotated[Mapping[str, RemainingGap], Field(alias="gap")] = field(default_factory=dict)
    shows: DetectionLimits | None = None
    conditions: Mapping[str, Exact] = field(default_factory=dict)
    rig: Mapping[str, str] = field(default_factory=dict)
    provenance: Mapping[str, Any] = field(default_factory=dict)
    response: Response | None = None

    @property
    def kind(self) -> AxisKind:
        """Of the axis."""
        return axis_kind(self.rig.get("kind"), "kind")

    def require_source(self, source: str, where: object = "baseline") -> None:
        """InputError where this baseline is of recordings and a model is checked, or the other way round."""
        if self.source != source:
            raise InputError(where, f"found that of {self.source}", f"allowed: one of {source}; `--update` writes one")


#: What is in a file: as the types above, each with the form of its values.
_FILE = TypeAdapter(State)


def write_baseline(path: str | Path, state: State) -> None:
    """Write a state, whole or not at all; InputError where the place cannot be written to, or has another file."""
    if Path(path).is_file() and SCHEMA.encode() not in read_bytes(path, "a baseline", replaced=True):
        found = "is no baseline, and would be lost"
        raise InputError(path, found, "allowed: a new file, or a baseline that bench check wrote")
    tables = _FILE.dump_python(state, by_alias=True)
    given = {key: table for key, table in tables.items() if table not in ("", {}) or key == "provenance"}
    write_text(path, HEAD + tomli_w.dumps(_without_none({"schema": SCHEMA, **given})))


def _without_none(content: Any) -> Any:  # noqa: ANN401 - TOML has no null
    if isinstance(content, Mapping):
        return {key: _without_none(value) for key, value in content.items() if value is not None}
    return [_without_none(value) for value in content] if isinstance(content, list | tuple) else content


def read_baseline(path: str | Path) -> State:
    """The state of a file; InputError where it is none, its schema is another, or a key is missing or wrong."""
    path = Path(path)
    if not path.exists():
        raise InputError(path, "no such baseline", "add `--update` to write one of this state")
    table = read_toml(path, "a baseline that bench check wrote", SCHEMA)
    try:
        state = _FILE.validate_python(table)
    except ValidationError as error:
        raise input_error(path, error) from error
    _require_whole(state, path)
    return state


def _require_whole(state: State, path: Path) -> None:
    """InputError where what is compared is not there."""
    for name in (name.removesuffix("_gap") for name in GAPS if name in state.quantities):
        if name not in state.gaps or state.gaps[name].noise_floor.value <= 0.0:
            raise InputError(f"{path}: gap.{name}", "missing, or without a noise floor", _ALLOWED)
    if state.source == "recordings":
        for name in (name for name in MOTION if name not in state.conditions):
            raise InputError(f"{path}: conditions.{name}", "missing", _ALLOWED)
    for index, one in enumerate(state.effects):
        count = len(one.effect.shapes)
        if one.shape is not None and len(one.shape) != count:
            found = f"found {list(one.shape)}"
            raise InputError(f"{path}: effects[{index}].shape", found, f"allowed: {count} numbers")
