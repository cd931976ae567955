"""The gate's checks as JSON (contract `checks`), and what is left to write where they end a command."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich import box
from rich.table import Table
from rich.text import Text

from bench.gate.check import Check
from bench.names import words
from bench.structured import json_text


def checks_json(checks: Sequence[Check]) -> list[dict[str, Any]]:
    """Each check under the names of the contract."""
    return [
        {
            "name": check.name,
            "status": check.status,
            "found": check.found,
            "allowed": check.allowed,
            "advice": check.advice,
        }
        for check in checks
    ]


def refusal_json(schema: str, checks: Sequence[Check], reason: str) -> str:
    """What was found of a recording that cannot answer."""
    return json_text({"schema": schema, "refused": reason, "checks": checks_json(checks)})


def checks_table(checks: Sequence[Check]) -> Table:
    """Each check with what was found, and what to do where it did not pass."""
    table = Table(box=box.SIMPLE_HEAD)
    for heading in ("check", "status"):
        table.add_column(heading, no_wrap=True)
    table.add_column("found")
    for check in checks:
        text = f"{check.found}: {check.advice}" if check.status in ("warn", "fail") and check.advice else check.found
        table.add_row(check.name, words(check.status), Text(text))
    return table
