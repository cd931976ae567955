"""A result as a notebook shows it: text of one screen, a small page, a figure, a dictionary, a data frame, a file.

What is shown is made by `bench.report.notebook`. As the public names of `bench`, it is loaded when it is first asked
for: a result knows that it can be shown, and no report.
"""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Presented:
    """A result that says itself what it comes to."""

    def __repr__(self) -> str:
        return _notebook().text(self)

    def _repr_html_(self) -> str:
        return _notebook().small_page(self)

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw what it shows into these axes, or into a new figure's, and return them.

        Raises:
            InputError: an estimate that was read from a file: it has no recording beside it.
        """
        return _notebook().plot(self, axes)

    def to_dict(self) -> dict[str, Any]:
        """All of it as numbers and texts, as `--json` writes it."""
        return json.loads(_notebook().overview(self).json)

    def to_frame(self) -> Any:  # noqa: ANN401 - of whichever of the two is there
        """Quantities with intervals, a row each, as a data frame of pandas or, without it, of polars.

        Raises:
            InputError: neither is installed.
        """
        return _notebook().frame(self)

    def save(self, path: str | Path) -> None:
        """Write all of it into a JSON file, as `--json` does; a diagnosis into a folder, with model and page."""
        _notebook().save(self, Path(path))


def _notebook() -> Any:  # noqa: ANN401 - a module
    return import_module("bench.report.notebook")
