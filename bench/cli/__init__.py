"""The command line: every command is thin, one verb of the bench and what a person wants to see of it.

A command imports what it works with when it runs: MuJoCo, scipy, matplotlib and pint together cost 1.8 s of CPU. Of
that `bench --help` needs nothing and `bench identify` a tenth; `bench --version` is answered without this module.

Another package offers commands as entry points of the group `servobench.commands`, each a function as those here:

    [project.entry-points."servobench.commands"]
    duty = "their_package.duty:duty"
"""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from traceback import extract_tb, print_exc, walk_tb
from types import FunctionType
from typing import Annotated

import typer
from typer import Option
from typer.exceptions import TyperException
from typer.main import get_command
from typer.models import CommandInfo

from bench import __version__
from bench.cli.check import check
from bench.cli.common import NOTES, guarded, say, warn
from bench.cli.grouped import RENAMED, Grouped
from bench.cli.lab import lab
from bench.cli.model import export, replay
from bench.cli.recording import diagnose, fleet, friction, identify, inspect, limits, robot
from bench.cli.servo import servo
from bench.cli.without_recording import demo, list_, plan, report, simulate, validate
from bench.errors import BenchError, InputError
from bench.names import short
from bench.offered import COMMANDS_GROUP, at_fault, offered

app = typer.Typer(pretty_exceptions_enable=False, rich_markup_mode=None, cls=Grouped)


@app.callback(invoke_without_command=True)
def bench(
    context: typer.Context,
    version: Annotated[bool, Option("--version", help="Print the version and stop.")] = False,
) -> None:
    """Test bench for a servo axis: simulate it in MuJoCo, and identify simulated and real ones alike."""
    if version:
        typer.echo(__version__)
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


#: Commands by what they are for, in the order of `bench --help`.
GROUPS = {
    "Start": (demo, inspect, list_),
    "Analyse": (identify, diagnose, friction, limits, validate),
    "Simulate": (simulate, replay, plan),
    "Watch": (check, fleet),
    "Robots and drives": (robot, servo, export),
    "Course": (lab,),
}
COMMANDS = {command.__name__.rstrip("_"): command for group in GROUPS.values() for command in group}
for heading, group in GROUPS.items():
    for command in group:
        name = command.__name__.rstrip("_")
        app.command(name, short_help=command.__doc__, rich_help_panel=heading)(guarded(command))
app.command(hidden=True)(guarded(report))

#: Errors of writing where nobody named a file.
UNWRITABLE = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)
#: Errors of a system that has no more to give, whatever it was asked for.
SCARCE = (errno.EMFILE, errno.ENFILE, errno.EAGAIN, errno.ENOMEM)
#: Characters of a line of an error; a path may have 4096.
LONGEST = 6000


def main() -> None:
    """Entry point of `bench`: errors become one line on standard error and an exit status."""
    try:
        if sys.stdout is None:
            raise InputError("standard output", "is closed", f"send it to a file, or to {os.devnull}")
        if isinstance(sys.stdout, io.TextIOWrapper):
            sys.stdout.reconfigure(errors="backslashreplace")  # as standard error is
        _add_offered()
        NOTES.clear()
        status = _built(tuple(app.registered_commands))(standalone_mode=False)
        sys.stdout.flush()
        warn(NOTES)
    except BenchError as error:
        warn(NOTES if error.exit_status == 1 else ())
        sys.exit(_failed(str(error), error.exit_status))
    except TyperException as error:
        sys.exit(_failed(_misused(error), 2))
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(_failed("interrupted", 130))
    except (BrokenPipeError, SystemExit) as end:
        if isinstance(end, BrokenPipeError) or isinstance(
            end.__context__, BrokenPipeError
        ):  # rich makes it a SystemExit
            _leave_output()  # the reader of what is printed has seen enough
            sys.exit(141)
        *_, (last, _) = walk_tb(end.__traceback__)
        if str(last.f_globals.get("__name__")).startswith("typer."):  # shell completion
            raise
        sys.exit(_failed(_fault(end), 70))  # code of a package ended the run, and there may be no result
    except Exception as fault:
        if isinstance(fault, OSError) and fault.filename is None and fault.errno in UNWRITABLE:
            _leave_output()
            sys.exit(_failed(f"standard output: cannot be written ({fault.strerror}); send it where there is room", 2))
        if isinstance(fault, OSError) and fault.errno in SCARCE:
            sys.exit(_failed(f"the system: {fault.strerror}; raise its limit (ulimit -n, -u), or run less at once", 2))
        sys.exit(_failed(_fault(fault), 70))
    sys.exit(status if isinstance(status, int) else 0)


def _misused(error: TyperException) -> str:
    """What is wrong with the words after `bench`, what was meant, and where to see what is allowed."""
    context, parameter = (getattr(error, name, None) for name in ("ctx", "param"))
    of = f"bench {context.info_name}" if context is not None and context.parent is not None else "bench"
    found, meaning = error.format_message().rstrip("."), getattr(parameter, "help", None)
    found += f" ({meaning.rstrip('.')})" if meaning else ""
    return f"{found}{' See' if found.endswith('?') else '; see'} `{of} --help`"


@cache
def _built(_commands: tuple[CommandInfo, ...]) -> Callable[..., object]:
    """`bench` with these commands, built once per process: that costs 20 ms."""
    return get_command(app)


def _leave_output() -> None:
    """Have the rest of standard output, which Python flushes once more at its end, go nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _add_offered() -> None:
    """Add the commands of other packages; InputError if one is no function, or has the name of one of the bench."""
    for name, command in offered(COMMANDS_GROUP, FunctionType, "a function"):
        if name in {*COMMANDS, *RENAMED, report.__name__}:
            raise InputError(f"{COMMANDS_GROUP}: {name}", "found a name of the bench", "allowed: a name of its own")
        if name not in {known.name for known in app.registered_commands}:
            app.command(name)(guarded(command))


def _fault(fault: BaseException) -> str:
    """The message on an exception that nobody foresaw: it is never mistaken for bad input."""
    if isinstance(fault, MemoryError):
        return "out of memory; give less at a time, or a machine with more"
    last = extract_tb(fault.__traceback__)[-1]
    place = f"{Path(last.filename).name}:{last.lineno}"
    what = f"{type(fault).__name__}: {short(str(fault))}" if str(fault) else type(fault).__name__
    whose = at_fault(fault.__traceback__) or "the bench itself"
    told = " as SECURITY.md describes" if whose == "the bench itself" else " there"
    again = "" if "--debug" in sys.argv else "; run it again with --debug, and"
    return f"a fault of {whose}, not of your input ({what}, at {place}){again} report it{told}"


def _failed(message: str, status: int) -> int:
    if "--debug" in sys.argv and sys.exc_info()[0] is not None:
        print_exc()
    line = " ".join(message.replace("Value error, ", "").split())
    if line:
        say(f"bench: {short(line, LONGEST)}", err=True, tone="red")
    return status
