"""The command `bench`, run in this process in a folder with a rig file."""

import os
import sys

from bench.cli import main

RIG = 'name = "axis"\nkind = "rotary"\n[motor]\ntorque_constant = "0.8 N*m/A"\nrotor_inertia = "2 kg*cm**2"\n'


def started(folder):
    """Runs `bench` and returns its status."""

    def run(*arguments):
        old, sys.argv = sys.argv, ["bench", *map(str, arguments)]
        try:
            main()
        except SystemExit as stop:
            return stop.code
        finally:
            sys.argv = old

    os.chdir(folder)
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")
    return run
