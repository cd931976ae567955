"""The command `bench`, run in this process."""

from __future__ import annotations

import sys
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from typing import NamedTuple
from unittest.mock import patch

from bench.cli import main


class Done(NamedTuple):
    """Exit status, and what was printed on standard output and standard error."""

    status: int
    out: str
    err: str


def bench(*arguments: object) -> Done:
    """Run `bench` with arguments, in the working folder; what it raises but its exit is passed on."""
    words = ["bench", *map(str, arguments)]
    with patch.object(sys, "argv", words), redirect_stdout(StringIO()) as out, redirect_stderr(StringIO()) as err:
        try:
            main()
        except SystemExit as stop:
            return Done(int(stop.code or 0), out.getvalue(), err.getvalue())
    raise AssertionError("bench ends with its exit status")
