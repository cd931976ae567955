"""A result as a notebook shows it: text of one screen, a small page, a figure, a dictionary, a data frame, a file.

The public package `bench` provides the renderer, as it is above both results and reports.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Renderer(Protocol):
    """What shows any result: a function for each method of `Presented`."""

    def text(self, result: object, /) -> str:
        """Text of one screen."""
        ...

    def small_page(self, result: object, /) -> str:
        """HTML of a cell."""
        ...

    def plot(self, result: object, axes: Axes | None, /) -> Axes:
        """The axes drawn into."""
        ...

    def content(self, result: object, /) -> dict[str, Any]:
        """The contract's JSON."""
        ...

    def frame(self, result: object, /) -> Any:  # noqa: ANN401 - of pandas or polars
        """A row for each quantity."""
        ...

    def save(self, result: object, path: Path, /) -> None:
        """Files with all of it."""
        ...


class Presented:
    """A result with methods that show it.

    Attributes:
        renderer: loads what shows it, when that is first needed.
    """

    renderer: ClassVar[staticmethod[[], Renderer]]

    def __repr__(self) -> str:
        return self.renderer().text(self)

    def _repr_html_(self) -> str:
        return self.renderer().small_page(self)

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw what it shows into these axes, or into a new figure's, and return them.

        Raises:
            InputError: an estimate that was read from a file: it has no recording beside it.
        """
        return self.renderer().plot(self, axes)

    def to_dict(self) -> dict[str, Any]:
        """All of it as numbers and texts, as `--json` writes it."""
        return self.renderer().content(self)

    def to_frame(self) -> Any:  # noqa: ANN401 - of whichever of the two is there
        """Quantities with intervals, a row each, as a data frame of pandas or, without it, of polars.

        Raises:
            InputError: neither is installed.
        """
        return self.renderer().frame(self)

    def save(self, path: str | Path) -> None:
        """Write all of it into a JSON file, as `--json` does; a diagnosis into a folder, with model and page."""
        self.renderer().save(self, Path(path))
