"""Run `bench` and kill it just before its n-th step of writing: making, opening to write, naming or removing a file.

    python -m tests.studies.crash.steps FOLDER N NOTE ARGUMENT...

N = 0 lets it run, and writes the number of its steps into the file NOTE.
"""

import os
import signal
import sys
from itertools import count
from pathlib import Path

from bench.__main__ import main

#: Of Python's audit events, those that change what lies in a folder.
CHANGES = {"os.rename", "os.remove", "os.mkdir", "os.chmod", "os.truncate", "os.link", "os.symlink"}
WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT


def kill_before(step: int, folder: str, note: Path) -> None:
    """Let the process kill itself before this step of those within a folder."""
    steps = count(1)

    def hook(event: str, details: tuple[object, ...]) -> None:
        opened = event == "open" and isinstance(details[2], int) and details[2] & WRITES
        if not (opened or event in CHANGES):
            return
        path = details[0]
        if isinstance(path, str | os.PathLike) and str(Path(path).absolute()).startswith(folder):
            number = next(steps)
            if number == step:
                os.kill(os.getpid(), signal.SIGKILL)
            if step == 0:
                note.write_text(str(number))

    sys.addaudithook(hook)


if __name__ == "__main__":
    kill_before(int(sys.argv[2]), str(Path(sys.argv[1]).absolute()), Path(sys.argv[3]))
    del sys.argv[1:4]
    main()
