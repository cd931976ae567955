"""`bench effects`."""

from __future__ import annotations

from typing import Annotated

import typer

from bench.cli.common import printed


def effects(
    name: Annotated[
        str | None, typer.Argument(help="Effect whose page to print; all of them as a table without.")
    ] = None,
) -> None:
    """List the physical effects the bench knows, or print the page of one: equation, quantities, source."""
    from bench.report.effects import effect_page, effects_table

    if name is None:
        printed(effects_table())
    else:
        typer.echo(effect_page(name))
