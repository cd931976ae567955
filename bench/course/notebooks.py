"""A notebook for each task: its text, cells to fill in, and checks of what a result must fulfil, without telling it.

Each is written from a text in `data/lab/notebooks`, Markdown with three kinds of code: `python given` is there,
`python check` checks, and `python yours NAME` is to be filled in.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from bench.assets import asset
from bench.errors import InputError
from bench.files import write_text

TEXTS = asset("data", "lab", "notebooks")
_CELL = re.compile(r"```python (given|check|yours)(?: (\w+))?\n(.*?)```\n?", re.DOTALL)
HINT = "# your turn\n"


def write_notebooks(folder: Path) -> list[Path]:
    """Write `task01.ipynb`, ... into a student's folder, beside the recordings; none that is there is overwritten.

    Raises:
        InputError: one of them is there, and may hold a student's work.
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
    """A notebook (nbformat 4.5) as JSON.

    Args:
        text: of the task.
        filled: code for cells by their names, instead of what the skeleton has.
    """
    cells = [{"id": f"cell-{k}", "metadata": {}, **cell} for k, cell in enumerate(_cells(text, filled or {}))]
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    content = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _cells(text: str, filled: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    start = 0
    for match in _CELL.finditer(text):
        yield from _markdown(text[start : match.start()])
        kind, name, code = match.groups()
        source = filled.get(name, HINT + code) if kind == "yours" else code
        yield {"cell_type": "code", "execution_count": None, "outputs": [], "source": source.rstrip("\n")}
        start = match.end()
    yield from _markdown(text[start:])


def _markdown(text: str) -> Iterator[dict[str, Any]]:
    if text.strip():
        yield {"cell_type": "markdown", "source": text.strip()}


def check(what: str, holds: Callable[..., object], *values: object) -> bool | None:
    """Print whether a condition holds.

    Args:
        what: must hold, in words.
        holds: asked with the values.
        values: of the student; `...` where a cell is not filled in yet.

    Returns:
        Whether it holds; None while a value is open.
    """
    if any(value is ... for value in values):
        print(f"open: {what}")
        return None
    try:
        found = bool(holds(*values))
    except (TypeError, ValueError, IndexError, AttributeError) as error:
        # a value of another kind or shape than was asked for: the condition does not hold, and why is said
        print(f"not yet: {what} ({type(error).__name__}: {error})")
        return False
    print(f"{'ok' if found else 'not yet'}: {what}")
    return found
