"""The pages of the commands, as Markdown, from the definitions of the command line itself."""

from __future__ import annotations

import inspect
from typing import Any

import typer

from bench.cli import app


def commands() -> dict[str, Any]:
    """Every command of `bench --help` by its name."""
    group: Any = typer.main.get_command(app)
    return {name: one for name, one in group.commands.items() if not one.hidden}


def page(name: str, command: Any) -> str:  # noqa: ANN401 - a class that typer keeps to itself
    """The page of a command: what it does, its usage, its arguments and options."""
    context = command.make_context(f"bench {name}", [], resilient_parsing=True)
    usage = " ".join(command.get_usage(context).split()).removeprefix("Usage: ")
    parts = [f"# bench {name}", cell(inspect.cleandoc(command.help or "")), f"```text\n{usage}\n```"]
    for heading, kind in (("Argument", "argument"), ("Option", "option")):
        records = [p.get_help_record(context) for p in command.get_params(context) if p.param_type_name == kind]
        rows = [f"| `{one[0].replace('|', chr(92) + '|')}` | {cell(one[1])} |" for one in records if one is not None]
        if rows:
            parts.append("\n".join([f"## {heading}s\n", f"| {heading.lower()} | meaning |", "|---|---|", *rows]))
    return "\n\n".join(parts) + "\n"


def table(found: dict[str, Any]) -> str:
    """All commands with their first line, for the page that lies two folders above theirs."""
    rows = [
        f"| [bench {name}](reference/commands/{name}.md) | {cell((one.help or '').splitlines()[0])} |"
        for name, one in found.items()
    ]
    return "\n".join(["| command | what it does |", "|---|---|", *rows]) + "\n"


def cell(text: str) -> str:
    """Text in which nothing is markup."""
    for sign in ("\\", "*", "_", "|", "<", "[", "`"):
        text = text.replace(sign, f"\\{sign}")
    return " ".join(text.split())
