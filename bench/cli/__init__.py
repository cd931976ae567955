"""The command line: every command is thin, one verb of the bench and what a person wants to see of it.

A command imports what it works with when it runs: MuJoCo, scipy, matplotlib and pint together cost 1.8 s of CPU. Of
that `bench --help` needs nothing and `bench identify` a tenth; `bench --version` is answered without this module.
"""

from __future__ import annotations

import sys
from typing import Annotated

import typer
from typer.exceptions import TyperException

from bench import __version__
from bench.cli.demo import demo
from bench.cli.diagnose import diagnose
from bench.cli.effects import effects
from bench.cli.friction import friction
from bench.cli.identify import identify
from bench.cli.inspect import inspect
from bench.cli.lab import lab
from bench.cli.limits import limits
from bench.cli.replay import replay
from bench.cli.rigs import rigs
from bench.cli.simulate import simulate
from bench.errors import BenchError

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)


@app.callback(invoke_without_command=True)
def bench(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    """Test bench for a servo axis: simulate it in MuJoCo, and identify simulated and real ones alike."""
    if version:
        typer.echo(__version__)
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


for command in (demo, simulate, effects, inspect, identify, diagnose, replay, friction, lab, limits, rigs):
    app.command()(command)


def main() -> None:
    """Entry point of `bench`: errors become one line on standard error and an exit status."""
    try:
        status = app(standalone_mode=False)
    except BenchError as error:
        sys.exit(_failed(str(error), error.exit_status))
    except TyperException as error:
        sys.exit(_failed(error.format_message(), 2))
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(_failed("interrupted", 130))
    sys.exit(status if isinstance(status, int) else 0)


def _failed(message: str, status: int) -> int:
    line = " ".join(message.replace("Value error, ", "").split())
    if line:
        typer.echo(f"bench: {line}", err=True)
    return status
