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
spread = "not told by fewer than two recordings"
[[effects]]
name = "cogging_torque"
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from bench.axis_kind import AxisKind, axis_kind
from bench.comparison.difference import Measured
from bench.effects.effect import Effect
from bench.effects.present import named
from bench.errors import InputError
from bench.files import write_text
from bench.structured import read_toml

#: Quantities that are not parameters: gaps over their noise floors.
GAPS = TORQUE_GAP, VELOCITY_GAP = "torque_gap", "velocity_gap"
#: What a file tells of each gap.
OF_GAP = "after", "noise_floor"
#: Conditions that turn a torque into the change of a parameter that it makes.
MOTION = "rms_speed", "rms_acceleration", "rms_effort"
#: Share by which the harmonics of two waves may differ and still be one: the pitch of a linear axis is fitted.
SAME_WAVE = 0.01
#: Number of instants at which the torque of a model's run is kept.
INSTANTS = 24

SCHEMA = "bench.baseline/1"
HEAD = "# The baseline of bench check; bench check --update writes it again.\n"
#: Written instead of an unknown spread.
NO_SPREAD = "not told by fewer than two recordings"
_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?: (.+))?")
_ALLOWED = "allowed: as bench check --update wrote it"
#: Magnitudes of what is known of an axis, unless it is zero: their fourth powers, which comparisons take, are numbers.
LEAST, MOST = 1e-60, 1e60


@dataclass(frozen=True)
class NamedHere:
    """An effect of a state.

    Attributes:
        effect: what it is.
        quantities: of it.
        shape: in the torque balance, in the effect's order; None for one read directly from signals.
        on_load: whether it acts on the load behind a coupling.
        torque: RMS torque that the rest of the model cannot explain - N*m (N); None outside the torque balance.
        ambiguous_with: names of effects that the recording cannot distinguish from it.
        gain: reduction of the squared residual over that of noise; nan outside the torque balance.
    """

    effect: Effect
    quantities: Mapping[str, Measured]
    shape: tuple[float, ...] | None = None
    on_load: bool = False
    torque: Measured | None = None
    ambiguous_with: tuple[str, ...] = ()
    gain: float = float("nan")

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

    def same(self, other: NamedHere) -> bool:
        """Whether it is the same effect of the same harmonic."""
        pairs = zip(self.whole, other.whole, strict=False)
        alike = all(bool(np.isclose(a[1], b[1], rtol=SAME_WAVE, atol=0.0)) for a, b in pairs)
        return self.effect is other.effect and alike

    def indistinguishable_from(self, other: NamedHere) -> bool:
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
    """RMS of a gap that remains with the effects found, and its noise floor, from noise alone - unit."""

    after: float
    noise_floor: float
    unit: str


@dataclass(frozen=True)
class DetectionLimits:
    """Smallest effects that a recording would have shown.

    Attributes:
        torque: RMS torque from which on an effect with one parameter is significant - N*m (N).
        left: RMS torque that the residual may hide - N*m (N).
    """

    torque: float
    left: float


@dataclass(frozen=True)
class Response:
    """A run of a model: the drive's torque at INSTANTS of it - N*m (N).

    Drive and speeds are laid out for an inertia - kg*m**2 (kg) - and a largest acceleration - rad/s**2 (m/s**2).
    """

    inertia: float
    acceleration: float
    torque: tuple[float, ...]


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
    names: bool
    quantities: Mapping[str, Measured]
    effects: tuple[NamedHere, ...] = ()
    verdict: str = ""
    gaps: Mapping[str, RemainingGap] = field(default_factory=dict)
    shows: DetectionLimits | None = None
    conditions: Mapping[str, Measured] = field(default_factory=dict)
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


def write_baseline(path: str | Path, state: State) -> None:
    """Write a state, whole or not at all; InputError where the place cannot be written to."""
    gaps, shows = state.gaps, {} if state.shows is None else asdict(state.shows)
    content = {
        "schema": SCHEMA,
        "source": state.source,
        "names": state.names,
        "verdict": state.verdict or None,
        "provenance": state.provenance,
        "quantities": {name: _measured(found) for name, found in state.quantities.items()},
        "gap": {k: {key: _text(getattr(one, key), one.unit) for key in OF_GAP} for k, one in gaps.items()} or None,
        "shows": {key: _text(value, gaps["torque"].unit) for key, value in shows.items()} or None,
        "conditions": {key: _text(one.value, one.unit) for key, one in state.conditions.items()} or None,
        "rig": state.rig or None,
        "response": None if state.response is None else asdict(state.response),
        "effects": [_effect(effect) for effect in state.effects],
    }
    write_text(path, HEAD + tomli_w.dumps(_without_none(content)))


def _measured(found: Measured) -> dict[str, Any]:
    """A quantity; one that is exact has a value alone."""
    table = {"value": _text(found.value, found.unit)}
    if not found.std_error:
        return table
    return table | {
        "std_error": _text(found.std_error, found.unit),
        "degrees": round(found.degrees, 1) if math.isfinite(found.degrees) else None,
        "recordings": found.recordings,
        "spread": NO_SPREAD if found.spread is None else _text(found.spread, found.unit),
    }


def _effect(effect: NamedHere) -> dict[str, Any]:
    torque = effect.torque
    return {
        "name": effect.name,
        "ambiguous_with": effect.ambiguous_with,
        "shape": effect.shape,
        "on_load": None if effect.shape is None else effect.on_load,
        "torque": None if torque is None else _measured(torque),
        "gain": None if torque is None else effect.gain,
        "quantities": {key: _measured(found) for key, found in effect.quantities.items()},
    }


def _text(value: float, unit: str) -> str:
    """A number in as many digits as any comparison needs, with its unit."""
    return f"{value:.9g} {unit}" if unit != "dimensionless" else f"{value:.9g}"


def _without_none(content: Any) -> Any:  # noqa: ANN401 - TOML has no null
    if isinstance(content, Mapping):
        return {key: _without_none(value) for key, value in content.items() if value is not None}
    return [_without_none(value) for value in content] if isinstance(content, list | tuple) else content


def read_baseline(path: str | Path) -> State:
    """The state of a file; InputError where it is none, its schema is another, or a key is missing or wrong."""
    path = Path(path)
    if not path.exists():
        raise InputError(path, "no such baseline", "add `--update` to write one of this state")
    return _Table(str(path), "", read_toml(path, "a baseline that bench check wrote", SCHEMA)).state()


@dataclass(frozen=True)
class _Table:
    """A table of a baseline's file at a dotted place, and what it stands for; every error names file and key."""

    source: str
    place: str
    content: Mapping[str, Any]

    def error(self, key: str, found: str, allowed: str = _ALLOWED) -> InputError:
        """What is wrong with a key, or with the table itself where that is empty."""
        return InputError(f"{self.source}: {'.'.join(filter(None, (self.place, key)))}", found, allowed)

    def one(self, key: str, kind: type) -> Any:  # noqa: ANN401
        """A value of a kind that has to be there."""
        if key not in self.content:
            raise self.error(key, "missing")
        if not isinstance(self.content[key], kind):
            raise self.error(key, f"found {self.content[key]!r}")
        return self.content[key]

    def number(self, key: str) -> tuple[float, str]:
        """A number with its unit."""
        match = _NUMBER.fullmatch(text := self.one(key, str))
        if match is None:
            raise self.error(key, f"found {text!r}", "allowed: a number and its unit")
        return self.plain(key, float(match[1])), match[2] or "dimensionless"

    def plain(self, key: str, value: object) -> float:
        """A number that a key holds, alone or in a list."""
        if isinstance(value, bool) or not isinstance(value, float | int):
            raise self.error(key, f"found {value!r}", "allowed: a number")
        if value != 0.0 and not LEAST <= abs(value) <= MOST:
            raise self.error(key, f"found {value!r}", "allowed: a number as one of an axis can be")
        return float(value)

    def table(self, key: str) -> _Table:
        """A table of this one, empty where there is none."""
        found = self.content.get(key, {})
        if not isinstance(found, dict):
            raise self.error(key, f"found {found!r}", "allowed: a table")
        return _Table(self.source, f"{self.place}.{key}" if self.place else key, found)

    def tables(self, key: str) -> dict[str, _Table]:
        """Tables of a table of this one, by name."""
        found = self.table(key)
        return {name: found.table(name) for name in found.content}

    def state(self) -> State:
        """The whole file."""
        entries = enumerate(self.one("effects", list))
        effects = [_Table(self.source, f"effects[{k}]", entry).effect() for k, entry in entries]
        shows, conditions, rig = self.table("shows"), self.table("conditions"), self.table("rig")
        quantities = {name: one.measured() for name, one in self.tables("quantities").items()}
        gaps = {name: [one.number(key) for key in OF_GAP] for name, one in self.tables("gap").items()}
        for name in (name.removesuffix("_gap") for name in GAPS if name in quantities):
            if name not in gaps or gaps[name][1][0] <= 0.0:
                raise self.error(f"gap.{name}", "missing, or without a noise floor")
        if (source := self.one("source", str)) == "recordings":
            for name in MOTION:
                conditions.number(name)
        return State(
            source=source,
            names=self.one("names", bool),
            quantities=quantities,
            effects=tuple(effects),
            verdict=str(self.content.get("verdict", "")),
            gaps={name: RemainingGap(after, floor, unit) for name, ((after, unit), (floor, _)) in gaps.items()},
            shows=DetectionLimits(shows.number("torque")[0], shows.number("left")[0]) if shows.content else None,
            conditions={key: Measured(*conditions.number(key)) for key in conditions.content},
            rig={str(key): str(value) for key, value in rig.content.items()},
            provenance=self.table("provenance").content,
            response=self.table("response").response() if "response" in self.content else None,
        )

    def measured(self) -> Measured:
        """A quantity."""
        value, unit = self.number("value")
        if "std_error" not in self.content:
            return Measured(value, unit)
        error, _ = self.number("std_error")
        degrees, count = self.content.get("degrees", math.inf), self.one("recordings", int)
        degrees = math.inf if degrees == math.inf else self.plain("degrees", degrees)
        spread = None if self.content.get("spread", NO_SPREAD) == NO_SPREAD else self.number("spread")[0]
        if not (degrees > 0.0 and self.plain("recordings", count) > 0 and error >= 0.0 and (spread or 0.0) >= 0.0):
            raise self.error("", "found an error or a count below zero")
        return Measured(value, unit, error, degrees, count, spread)

    def response(self) -> Response:
        """The run of a model."""
        inertia, acceleration = (self.plain(key, self.one(key, float)) for key in ("inertia", "acceleration"))
        torque = tuple(self.plain("torque", one) for one in self.one("torque", list))
        if len(torque) != INSTANTS:
            raise self.error("torque", f"found {len(torque)} numbers", f"allowed: {INSTANTS}")
        if not min(inertia, acceleration) > 0.0:
            raise self.error("", f"found {inertia:g} and {acceleration:g}", "allowed: numbers above zero")
        return Response(inertia, acceleration, torque)

    def effect(self) -> NamedHere:
        """An effect."""
        if not isinstance(self.content, dict):
            raise self.error("", f"found {self.content!r}")
        effect = named(self.one("name", str), f"{self.source}: {self.place}.name")
        shape = self.one("shape", list) if "shape" in self.content else None
        if shape is not None and len(shape) != len(effect.shapes):
            raise self.error("shape", f"found {shape!r}", f"allowed: {len(effect.shapes)} numbers")
        return NamedHere(
            effect=effect,
            quantities={key: one.measured() for key, one in self.tables("quantities").items()},
            shape=None if shape is None else tuple(self.plain("shape", one) for one in shape),
            on_load=bool(self.content.get("on_load", False)),
            torque=self.table("torque").measured() if "torque" in self.content else None,
            ambiguous_with=tuple(map(str, self.one("ambiguous_with", list))),
            gain=self.plain("gain", self.content["gain"]) if "gain" in self.content else math.nan,
        )
