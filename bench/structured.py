"""TOML and JSON from files, with clear errors; strictly valid JSON; and CSV."""

from __future__ import annotations

import csv
import io
import json
import math
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

from bench.errors import InputError, UndeterminedError
from bench.files import read_text
from bench.names import cell

#: Python's message on an integer beyond 4300 digits is advice to a programmer.
TOO_MANY_DIGITS = "contains an integer of thousands of digits"
#: Levels of JSON; Arrow takes gigabytes for hundreds of them.
_DEEPEST = 64
#: Parts of a dotted key, which take `tomllib` the square of their number in time and memory; files of the bench have 4.
_MOST_PARTS = 64
_PART = r"""(?:[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')[ \t]*+"""
_CHAIN = re.compile(rf"(?<![\w-])(?:{_PART}\.[ \t]*+){{{_MOST_PARTS}}}")


def read_toml(path: str | Path, kind: str, schema: str | None = None) -> dict[str, Any]:
    """Tables of a TOML file; `kind` is what it should be, for messages, e.g. `a rig file`.

    InputError: as `parse_toml`, it cannot be read, or is of another schema than the one that it must have.
    """
    table = parse_toml(read_text(path, kind), path, kind)
    if schema is not None and table.get("schema") != schema:
        raise InputError(f"{path}: schema", f"found {table.get('schema')!r}", f"allowed: '{schema}'")
    return table


def parse_toml(text: str, where: object, kind: str = "TOML") -> dict[str, Any]:
    """Tables of a TOML text; `kind` as of `read_toml`.

    InputError: it is no TOML, is nested too deep, or has a number of too many digits; names `where`.
    """
    allowed = f"allowed: {kind} in UTF-8 TOML"
    long = _CHAIN.search(text)
    if long is not None:
        line = text.count("\n", 0, long.start()) + 1
        raise InputError(
            f"{where}: line {line}", f"found a key of more than {_MOST_PARTS} parts", "allowed: fewer dots"
        )
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise InputError(where, "its tables are nested too deep", allowed) from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(where, f"not TOML ({error})", allowed) from error
    except ValueError as error:
        raise InputError(where, TOO_MANY_DIGITS, allowed) from error


def parse_json(text: str, where: object) -> Any:  # noqa: ANN401
    """Content of a JSON text.

    InputError: not JSON, nested too deep, or a number of too many digits; names `where`, and the line.
    """
    try:
        content = json.loads(text)
        level: list[Any] = [[content]]
        for _ in range(_DEEPEST + 1):
            inner = chain.from_iterable(one.values() if type(one) is dict else one for one in level)
            level = [one for one in inner if type(one) in (dict, list)]
        if level:
            raise RecursionError
        return content
    except json.JSONDecodeError as error:
        found = f"the JSON is truncated or damaged ({error.msg})"
        raise InputError(f"{where}: line {error.lineno}", found, "allowed: whole JSON") from error
    except RecursionError as error:
        raise InputError(where, "the JSON is nested too deep", f"allowed: {_DEEPEST} levels") from error
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


def csv_of_texts(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table of texts as CSV, no cell of which a spreadsheet takes for a formula."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(head)
    writer.writerows([cell(str(content)) for content in row] for row in rows)
    return buffer.getvalue()


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
