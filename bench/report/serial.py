"""The one way from results to JSON: what a typed result is, its fields are; whatever is not known is null."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import singledispatch
from typing import Any

import numpy as np

from bench.gate.check import Check
from bench.parameter import Parameter
from bench.structured import json_text


def serialised(content: Mapping[str, Any]) -> str:
    """Plain values, dataclasses, mappings, sequences and arrays as the contract's JSON.

    Raises:
        UndeterminedError: a number of it is not finite; one that may be unknown goes through `known` first.
    """
    return json_text(as_json(content))


def known(value: float) -> float | None:
    """A number that may be unknown: JSON has no nan, so that it is null."""
    return value if math.isfinite(value) else None


def picked(result: object, *names: str) -> dict[str, Any]:
    """These attributes of a result, by their names."""
    return {name: as_json(getattr(result, name)) for name in names}


@singledispatch
def as_json(value: object) -> Any:  # noqa: ANN401 - what JSON can hold
    """A value as JSON has it; another one for a type is registered with it."""
    if isinstance(value, Mapping):
        return {key: as_json(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [as_json(each) for each in value]
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if is_dataclass(value):
        return picked(value, *(field.name for field in fields(value)))
    return value


@as_json.register
def _(found: Parameter) -> dict[str, Any]:
    bounds = [known(bound) for bound in found.ci95]
    return {"value": found.value, "unit": found.unit, "std_error": known(found.std_error), "ci95": bounds}


@as_json.register
def _(check: Check) -> dict[str, Any]:
    return picked(check, "name", "status", "found", "allowed", "advice")
