"""Differences between the rigs of two states, in the keys that identification reads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from bench.rig.rig import Rig
from bench.rig.values import tolerance_of

#: Tables and keys of a rig that no result depends on: its name, the truth of a simulation, what a check allows, and the
#: drive, whose effect on the motion is compared separately.
BESIDE = frozenset({"name", "simulation", "check", "drive"})


def rig_values(rig: Rig) -> dict[str, str]:
    """The keys that identification reads of a rig, dotted, with their values as text in SI."""
    tables = {key: value for key, value in rig if key not in BESIDE and key != "source"}
    found = dict(_flat("", {key: value for key, value in tables.items() if value is not None}))
    if rig.drive is not None:
        found["drive.control_period"] = _text(rig.drive.control_period)
    return found


def _flat(place: str, value: Any) -> Iterator[tuple[str, str]]:  # noqa: ANN401 - whatever a rig holds
    if value is None:
        return
    items = value.items() if isinstance(value, Mapping) else dict(value).items() if _is_table(value) else None
    if items is not None:
        for key, part in items:
            yield from _flat(f"{place}.{key}" if place else key, part)
    elif isinstance(value, list | tuple):
        for number, part in enumerate(value):
            yield from _flat(f"{place}[{number}]", part)
    else:
        yield place, _text(value)


def _is_table(value: object) -> bool:
    from pydantic import BaseModel

    return isinstance(value, BaseModel)


def _text(value: object) -> str:
    if not isinstance(value, float):
        return str(value)
    tolerance = tolerance_of(value)
    return f"{float(value):.9g} +/- {tolerance:.3g}" if tolerance else f"{value:.9g}"


def differing(baseline: Mapping[str, str], now: Mapping[str, str]) -> list[str]:
    """A line for each key that differs."""
    return [
        f"{key}: {baseline.get(key, 'not given')} -> {now.get(key, 'not given')}"
        for key in dict.fromkeys([*baseline, *now])
        if baseline.get(key) != now.get(key)
    ]
