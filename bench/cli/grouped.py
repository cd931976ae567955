"""Commands under headings in `bench --help`, and earlier names of commands."""

from __future__ import annotations

from typing import Any

from typer.core import TyperGroup

from bench.cli.common import NOTES

#: Words that replace an earlier name of a command. Of `view`, `--out` is `--page`, with a default.
RENAMED = {
    "view": ("replay",),
    "compensate": ("export", "--to", "drive"),
    "rigs": ("list", "rigs"),
    "effects": ("list", "effects"),
}
#: Heading of commands of other packages.
OTHERS = "Other packages"


def renamed(words: list[str]) -> list[str]:
    """Words of a command line with the present name of its command, with a note on it, printed at the end."""
    first, *rest = words
    if first not in RENAMED:
        return words
    if first == "view" and "--help" not in rest:
        rest = [f"--page{word[5:]}" if word.split("=")[0] == "--out" else word for word in rest]
        rest += [] if any(word.split("=")[0] == "--page" for word in rest) else ["--page", "view.html"]
    option = " --page" if first == "view" else ""
    NOTES[f"`bench {first}` is now `bench {' '.join(RENAMED[first])}{option}`"] = None
    return [*RENAMED[first], *rest]


class Grouped(TyperGroup):
    """The group of all commands."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:  # noqa: ANN401 - classes that typer keeps to itself
        """Write each command with its first line, below the heading of its panel."""
        groups: dict[str, list[tuple[str, str]]] = {}
        for name, command in self.commands.items():
            if not command.hidden:
                heading = getattr(command, "rich_help_panel", None)
                rows = groups.setdefault(heading if isinstance(heading, str) else OTHERS, [])
                rows.append((name, command.get_short_help_str(1000)))
        widest = max(len(name) for rows in groups.values() for name, _ in rows)
        for heading, rows in groups.items():
            with formatter.section(heading):
                formatter.write_dl([(name.ljust(widest), text) for name, text in rows])

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:  # noqa: ANN401
        """The command of these words, under its present or its earlier name."""
        return super().resolve_command(ctx, renamed(args))
