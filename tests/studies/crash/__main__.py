"""Kill commands at moments spread evenly over their run and over their writing, and look at what they leave.

    python -m tests.studies.crash --kills 300

Half of the kills fall anywhere into a command's run, a quarter into its writing by the clock, a quarter exactly before
one of its steps of writing. After each, every file has to be whole or absent, no input may have changed and no process
live on; every few kills the command runs to its end, which has to succeed and to leave nothing but its outputs.
Whatever is found is printed, and ends it with 1.
"""

import argparse
import os
import shutil
import signal
import tempfile
import time
from pathlib import Path

from tests.hostile import ROOT
from tests.studies.crash.commands import COMMANDS
from tests.studies.crash.kills import Trial


def options() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.studies.crash")
    parser.add_argument("--kills", type=int, default=300, help="of all commands together")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="after which no further kill begins")
    parser.add_argument("--signal", default="KILL", choices=["KILL", "TERM", "INT", "HUP"])
    parser.add_argument("--commands", nargs="*", default=list(COMMANDS), choices=list(COMMANDS))
    return parser


def main() -> None:
    asked = options().parse_args()
    os.environ["PYTHONPATH"] = str(ROOT)
    faults = []
    for number, name in enumerate(asked.commands):
        kills = asked.kills // len(asked.commands) + (number < asked.kills % len(asked.commands))
        until = time.monotonic() + asked.seconds / len(asked.commands)
        above = Path(tempfile.mkdtemp(prefix="crash-"))
        try:
            found = _killed(name, kills, until, above, asked.signal)
        finally:
            shutil.rmtree(above)
        faults += [f"{name}: {one}" for one in found]
    if faults:
        raise SystemExit("\n".join(faults))


def _killed(name: str, kills: int, until: float, above: Path, number: str) -> list[str]:
    (above / "trial").mkdir()
    trial = Trial(COMMANDS[name], above / "trial", signal.Signals[f"SIG{number}"])
    tally = trial.killed(kills, until)
    moments = ", ".join(f"{moment} {count}" for moment, count in sorted(tally.kills.items()))
    strays = sorted({path.name for path in trial.temporary.iterdir()} - {"steps"})
    print(
        f"{name}: {tally.kills.total()} kills ({moments}; {tally.missed} came too late), {trial.pace.steps} steps, "
        f"{tally.looked} files whole or not, {tally.left} under way left, {tally.ended} runs to the end, "
        f"{len(tally.faults)} faults; in the system's temporary folder: {strays or 'nothing'}",
        flush=True,
    )
    return tally.faults


if __name__ == "__main__":
    main()
