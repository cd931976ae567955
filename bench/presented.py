"""A result as a notebook shows it: text of one screen, a small page, a figure, a dictionary, a data frame, a file.

The public package `bench` provides the renderer, as it is above both results and reports.
"""

from __future__ import annotations

from abc import ABCMeta
from collections.abc import Iterable, Sequence
from dataclasses import is_dataclass
from pathlib import Path
from types import FunctionType
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeAlias

from bench.errors import InputError
from bench.files import write_text
from bench.names import OF_FRAMES, instead, meant, mistake, same_as, with_known_arguments

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from numpy.typing import NDArray


#: Width and height - inch.
Size: TypeAlias = tuple[float, float]


class Renderer(Protocol):
    """What shows any result: a function for each method of `Shown` and `Presented`."""

    def text(self, result: object, /) -> str:
        """Text of one screen."""
        ...

    def small_page(self, result: object, /) -> str:
        """HTML of a cell."""
        ...

    def plot(
        self, result: object, names: Sequence[str], ax: Axes | None, figsize: tuple[float, float] | None, /
    ) -> Any:  # noqa: ANN401
        """The axes drawn into: one, or an array of them."""
        ...

    def json(self, result: object, /) -> str:
        """The contract's JSON."""
        ...

    def content(self, result: object, /) -> dict[str, Any]:
        """The same as plain values."""
        ...

    def frame(self, result: object, /) -> Any:  # noqa: ANN401 - of pandas or polars
        """A row for each sample of signals, or for each quantity."""
        ...

    def along(
        self, result: object, recording: object = None, /
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Time, measured effort, and that less the modelled one, of its own recording or of another."""
        ...

    def save(self, result: object, path: Path, /) -> None:
        """Files with all of it."""
        ...


class ByKey(dict[str, Any]):
    """A dictionary whose error for a key that is not there names those that are."""

    def __missing__(self, key: str) -> Any:  # noqa: ANN401 - a value of it
        return meant(key, self)


class LabelledTuple(tuple[Any, ...]):
    """Parts of a result in their order, each by its place or its label."""

    def __getitem__(self, which: Any) -> Any:  # noqa: ANN401 - a part, or several
        return _labelled(self, which) if isinstance(which, str) else super().__getitem__(which)


class LabelledList(list[Any]):
    """The same as a list."""

    def __getitem__(self, which: Any) -> Any:  # noqa: ANN401 - a part, or several
        return _labelled(self, which) if isinstance(which, str) else super().__getitem__(which)


def _labelled(parts: Iterable[Any], label: str) -> Any:  # noqa: ANN401 - one of them
    return meant(label, {_label(one): one for one in parts})


def _label(part: object) -> str:
    """What names a part of a result among others; empty of one that has no name."""
    labels = (getattr(part, of, None) for of in ("name", "coordinate", "effect") if is_dataclass(part))
    named = (each if isinstance(each, str) else getattr(each, "name", "") for each in labels)
    return next(filter(None, named), "")


def _by_name(value: object) -> object:
    """A dictionary, or parts with labels, whose entries are found by name."""
    match value:
        case dict() if type(value) is dict:
            return ByKey(value)
        case tuple() if type(value) is tuple and any(map(_label, value)):
            return LabelledTuple(value)
        case list() if type(value) is list and any(map(_label, value)):
            return LabelledList(value)
    return value


class Constructed(ABCMeta):
    """Of classes whose constructors are found under names that other libraries have for them.

    A call of a method or of the class with wrong arguments is one line with those that are allowed.
    """

    if not TYPE_CHECKING:

        def __init__(cls, name: str, bases: tuple[type, ...], space: dict[str, Any], **options: object) -> None:
            super().__init__(name, bases, space, **options)
            for each, of in space.items():
                if each[0] != "_" and isinstance(of, FunctionType):
                    setattr(cls, each, with_known_arguments(of))
                elif each[0] != "_" and isinstance(of, classmethod):
                    setattr(cls, each, classmethod(with_known_arguments(of.__func__)))

        def __call__(cls, *args: object, **given: object) -> object:
            """An instance, whose parts are found by name."""
            try:
                made = super().__call__(*args, **given)
            except (AttributeError, TypeError, ValueError) as error:
                said = mistake(cls.__init__, (None, *args), given)
                if said is None:
                    raise
                raise TypeError(said) from error
            if is_dataclass(made):
                for name, value in [*vars(made).items()]:
                    if (named := _by_name(value)) is not value:
                        object.__setattr__(made, name, named)
            return made

        def __getattr__(cls, name: str) -> object:
            if name.startswith("_"):
                raise AttributeError(name)
            kinds = [kind for kind in cls.__mro__ if not kind.__module__.startswith("pydantic")]
            own = [each for kind in kinds for each, of in vars(kind).items() if isinstance(of, classmethod)]
            known = [each for each in own if not each.startswith("_")]
            if (same := same_as(name, known)) is not None:
                return getattr(cls, same)
            raise AttributeError(f"{cls.__name__} has no '{name}'{instead(name, known)}")


class ByName(metaclass=Constructed):
    """What `[name]` gives is an attribute, too, as is what other libraries call its attributes."""

    def __getitem__(self, name: str) -> Any:  # noqa: ANN401 - an attribute
        return meant(name, {each: of for each, of in vars(self).items() if each[0] != "_"})

    if not TYPE_CHECKING:  # a checker of types shall find attributes that are mistyped

        def __getattr__(self, name: str) -> object:
            own = vars(self)
            if not name.startswith("_") and own:
                try:
                    return self[name]
                except (LookupError, TypeError, InputError):
                    kinds = [kind for kind in type(self).__mro__ if not kind.__module__.startswith("pydantic")]
                    known = sorted({each for of in (own, *map(vars, kinds)) for each in of if each[0] != "_"})
                    if (same := same_as(name, known)) is not None:
                        return getattr(self, same)
                    if name in OF_FRAMES and "to_frame" in known:
                        return getattr(self.to_frame(), name)
                    raise AttributeError(f"{type(self).__name__} has no '{name}'{instead(name, known)}") from None
            raise AttributeError(name)


class Shown(ByName):
    """Signals or a result, which can be drawn and made a table.

    Attributes:
        renderer: loads what shows it, when that is first needed.
    """

    renderer: ClassVar[staticmethod[[], Renderer]]

    def plot(self, *names: str, ax: Axes | None = None, figsize: Size | None = None) -> Any:  # noqa: ANN401
        """Draw it, and return the axes of matplotlib: one, or an array of several.

        Args:
            names: of what is drawn, e.g. of signals; all of it by default.
            ax: axes to draw the only or the first of them into, instead of a new figure.
            figsize: width and height of the new figure - inch.

        Raises:
            InputError: no such name, or an estimate that was read from a file: it contains no recording.
        """
        return self.renderer().plot(self, names, ax, figsize)

    def to_frame(self) -> Any:  # noqa: ANN401 - of whichever of the two is there
        """Signals over time, or quantities with intervals, as a data frame of pandas or, without it, of polars.

        Raises:
            InputError: neither is installed.
        """
        return self.renderer().frame(self)

    def save(self, path: str | Path) -> None:
        """Write all of it into a file: signals in the format of the path's ending (CSV, Parquet), a result as `--json`.

        A diagnosis is written into a folder, with model and page. Into a `.csv` any result goes as its table.
        """
        self.renderer().save(self, Path(path))


class Presented(Shown):
    """A result with methods that show it."""

    def __repr__(self) -> str:
        return self.renderer().text(self)

    def _repr_html_(self) -> str:
        return self.renderer().small_page(self)

    def summary(self) -> str:
        """The text of one screen that `print` shows."""
        return str(self)

    def to_html(self, path: str | Path | None = None) -> str:
        """What a notebook shows as HTML, written into a file if one is given."""
        page = self.renderer().small_page(self)
        if path is not None:
            write_text(path, page)
        return page

    def to_json(self, path: str | Path | None = None) -> str:
        """All of it as JSON, as `--json` writes it, written into a file if one is given."""
        text = self.renderer().json(self)
        if path is not None:
            write_text(path, text + "\n")
        return text

    def to_dict(self) -> dict[str, Any]:
        """The same as numbers and texts."""
        return self.renderer().content(self)
