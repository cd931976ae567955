"""TOML and JSON from files, with clear errors; strictly valid JSON; and CSV."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from bench.errors import InputError, UndeterminedError
from bench.files import read_text

#: What Python says of an integer beyond 4300 digits is advice to a programmer.
TOO_MANY_DIGITS = "holds an integer of thousands of digits"


def read_toml(path: str | Path, kind: str, schema: str | None = None) -> dict[str, Any]:
    """Tables of a TOML file; `kind` is what it should be, for messages, e.g. `a rig file`.

    InputError: it cannot be read, is no TOML, is nested too deep, holds a number of too many digits, or is of another
    schema than the one that it must have.
    """
    text = read_text(path, kind)
    try:
        table = tomllib.loads(text)
    except RecursionError as error:
        raise InputError(path, "its tables are nested too deep", f"allowed: {kind} (TOML)") from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(path, f"not TOML ({error})", f"allowed: {kind} in UTF-8 TOML") from error
    except ValueError as error:
        raise InputError(path, TOO_MANY_DIGITS, f"allowed: {kind} (TOML)") from error
    if schema is not None and table.get("schema") != schema:
        raise InputError(f"{path}: schema", f"found {table.get('schema')!r}", f"allowed: '{schema}'")
    return table


def parse_json(text: str, where: object) -> Any:  # noqa: ANN401
    """Content of a JSON text.

    InputError: not JSON, nested too deep, or a number of too many digits; names `where`, and the line.
    """
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        found = f"the JSON is truncated or damaged ({error.msg})"
        raise InputError(f"{where}: line {error.lineno}", found, "allowed: whole JSON") from error
    except RecursionError as error:
        raise InputError(where, "the JSON is nested too deep", "allowed: a few levels") from error
    except ValueError as error:
        raise InputError(where, TOO_MANY_DIGITS, "allowed: numbers") from error


def json_text(content: Mapping[str, Any], ascii_only: bool = True) -> str:
    """A result as JSON, whose unknown values are null; UndeterminedError if a number of it is not finite."""
    try:
        return json.dumps(content, indent=2, allow_nan=False, ensure_ascii=ascii_only)
    except ValueError as error:
        place, value = _not_finite(content) or ("the result", math.nan)
        record = "the motion again; numbers this large or this small are not those of a servo axis"
        raise UndeterminedError(place, f"it came out as {value}", record) from error


def csv_text(head: Sequence[str], rows: Iterable[Sequence[float]]) -> str:
    """A table as CSV, nine digits a number; an empty cell for nan."""
    lines = (",".join("" if math.isnan(value) else f"{value:.9g}" for value in row) for row in rows)
    return "\n".join([",".join(head), *lines]) + "\n"


def _not_finite(content: object, place: str = "") -> tuple[str, float] | None:
    """Place and value of the first number that is not finite."""
    if isinstance(content, float):
        return None if math.isfinite(content) else (place, content)
    if isinstance(content, Mapping):
        parts = [(f"{place}.{key}" if place else str(key), part) for key, part in content.items()]
    else:
        parts = [(f"{place}[{k}]", part) for k, part in enumerate(content)] if isinstance(content, list | tuple) else []
    return next((found for where, part in parts if (found := _not_finite(part, where))), None)
