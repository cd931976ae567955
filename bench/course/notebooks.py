"""A notebook for each task: its text, cells to fill in, and checks of what a result must fulfil, without giving it.

Each is written from a text in `data/lab/notebooks`, Markdown with three kinds of code: `python given` is there,
`python check` checks, and `python yours NAME` is to be filled in. `python yours NAME FILE` writes the
student's function into a file, which later tasks take it from.
"""

from __future__ import annotations

import json
import re
import runpy
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bench.arrays import Array
from bench.assets import asset
from bench.course.recordings import LabRecordings
from bench.errors import InputError
from bench.files import write_text
from bench.rig.motor import Motor
from bench.trace.read import read

TEXTS = asset("data", "lab", "notebooks")
_CELL = re.compile(r"```python (given|check|yours)(?: (\w+)(?: ([\w.]+))?)?\n(.*?)```\n?", re.DOTALL)
HINT = "# your turn\n"
#: The first cell of each.
FIRST = """\
import numpy as np
import matplotlib.pyplot as plt
from pathlib import Path
from bench.course.notebooks import check, check_signals, own, recorded
from bench.course.recordings import LabRecordings

folder = LabRecordings.in_folder(Path("."))
motor = folder.rig.motor
num_derivative, torqueconstant = own("num_derivative"), own("torqueconstant")


def signals(run):
    # t, omega, alpha and M of a recording by your own functions of tasks 2 and 4
    alpha = num_derivative(run.velocity, run.sample_period)
    return run.time, run.velocity, alpha, torqueconstant(run.current) * run.current
"""


def write_notebooks(folder: Path) -> list[Path]:
    """Write `task01.ipynb`, ... into a student's folder, next to the recordings.

    Raises InputError where one of them is there, as it may hold a student's work.
    """
    texts = sorted(TEXTS.glob("task*.md"))
    paths = [folder / f"{text.stem}.ipynb" for text in texts]
    present = [path.name for path in paths if path.exists()]
    if present:
        raise InputError(folder, f"found {', '.join(present)}", "move them away, or name another folder")
    for text, path in zip(texts, paths, strict=True):
        write_text(path, notebook(text.read_text(encoding="utf-8")))
    return paths


def notebook(text: str, filled: Mapping[str, str] | None = None) -> str:
    """A notebook (nbformat 4.5) of a task's text, as JSON; cells named in `filled` have that code, not a skeleton."""
    cells = [{"id": f"cell-{k}", "metadata": {}, **cell} for k, cell in enumerate(_cells(text, filled or {}))]
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    content = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _cells(text: str, filled: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    yield {"cell_type": "code", "execution_count": None, "outputs": [], "source": FIRST.rstrip("\n")}
    parts = _CELL.split(text)  # text, and of each cell of code its kind, name, file, code, and the text behind it
    for start in range(0, len(parts), 5):
        if parts[start].strip():
            yield {"cell_type": "markdown", "source": parts[start].strip()}
        if parts[start + 1 :]:
            kind, name, file, code = parts[start + 1 : start + 5]
            source = filled.get(name, HINT + code) if kind == "yours" else code
            source = f"%%writefile {file}\n{source}" if file else source
            yield {"cell_type": "code", "execution_count": None, "outputs": [], "source": source.rstrip("\n")}


class NotYetError(Exception):
    """A function that is not written yet."""


def own(name: str, function: str = "") -> Callable[..., Any]:
    """The student's own function of a file `NAME.py` here, as it is whenever it is called.

    Args:
        name: of the file.
        function: of the function in it; the file's name without.
    """

    def called(*arguments: object) -> Any:  # noqa: ANN401, a student's function gives anything
        path = Path(f"{name}.py")
        found = runpy.run_path(str(path))[function or name](*arguments) if path.exists() else ...
        if found is ...:
            raise NotYetError(f"{path} is not written yet")
        return found

    return called


def check(what: str, holds: Callable[..., object], *values: object) -> bool | None:
    """Print whether a condition is met.

    Args:
        what: must hold, in words.
        holds: called with the values.
        values: of the student; `...` where a cell is not filled in yet.

    Returns:
        Whether it is met; None while a value or a function is open.
    """
    if any(value is ... for value in values):
        print(f"open: {what}")
        return None
    try:
        found = bool(holds(*values))
    except NotYetError as missing:
        print(f"open: {what} ({missing})")
        return None
    except Exception as error:  # a student's code may raise anything: the condition is not met
        print(f"not yet: {what} ({type(error).__name__}: {error})")
        return False
    print(f"{'ok' if found else 'not yet'}: {what}")
    return found


def recorded(folder: LabRecordings, name: str) -> tuple[float, Array, Array, Array]:
    """Sample period - s; time - s -, speed - deg/s - and current - mA - (n,) of a recording, in the drive's units."""
    trace = read(folder.files(name)[0], folder.rig.trace.columns)
    return trace.sample_period, trace.time, np.degrees(trace["velocity"]), 1e3 * trace["current"]


def check_signals(
    motor: Motor, seen: tuple[float, Array, Array, Array], omega: object, alpha: object, torque: object
) -> None:
    """Check a student's speed - rad/s -, acceleration - rad/s**2 - and torque - N*m - of what `recorded` gives."""
    period, _, degrees_per_second, milliamperes = seen
    much, peak = milliamperes > 1e3, motor.peak_torque or np.inf
    check(
        "so many radians a second from lowest to highest as degrees",
        lambda w: np.isclose(360.0 * np.ptp(w), 2.0 * np.pi * np.ptp(degrees_per_second)),
        omega,
    )
    check("alpha adds up to the speed", lambda a, w: np.allclose(np.cumsum(a) * period, w - w[0]), alpha, omega)
    check("torque has the current's sign", lambda m: np.all(m * milliamperes >= 0.0), torque)
    ratio = "an ampere makes less torque at more current"
    check(ratio, lambda m: np.ptp(m[much] / milliamperes[much]) > 1e-5, torque)
    check("no more than the motor's peak", lambda m: np.abs(m).max() < 1.05 * peak, torque)
    check("torque goes with acceleration", lambda a, m: np.corrcoef(a, m)[0, 1] > 0.9, alpha, torque)
