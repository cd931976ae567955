"""Results of the lab course as JSON."""

from __future__ import annotations

import math
from collections.abc import Sequence

from bench import __version__
from bench.course.result import NotDone, Number, Task
from bench.structured import json_text

SCHEMA = "bench.lab/1"


def lab_json(results: Sequence[Task | NotDone], axis: str) -> str:
    """Every number with unit, truth where it is known, and source; of what was not done, what is missing.

    Args:
        results: of the course.
        axis: its name.
    """
    content = {"schema": SCHEMA, "version": __version__, "axis": axis, "tasks": [_task(result) for result in results]}
    return json_text(content, ascii_only=False) + "\n"


def _task(result: Task | NotDone) -> dict[str, object]:
    named = {"key": result.key, "title": result.title}
    if isinstance(result, NotDone):
        return {**named, "status": "not_done", "reason": str(result.reason)}
    return {
        **named,
        "status": "done",
        "embedded_example": result.example,
        "says": list(result.findings),
        "numbers": [_number(number) for number in result.numbers],
    }


def _number(number: Number) -> dict[str, object]:
    value = number.value if math.isfinite(number.value) else None
    return {"name": number.name, "value": value, "unit": number.unit, "truth": number.truth, "source": number.source}
