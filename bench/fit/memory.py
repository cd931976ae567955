"""Arrays of a recording that were made before: fits of one search differ in one effect and share all other columns."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence
from typing import Any

from bench.arrays import Array
from bench.trace.filter import Column

#: Bytes kept: on a recording of 8 s at 1 kHz some hundred columns, of 600 s what one hypothesis needs. With 96 MB less
#: than that was kept there, and 600 s took 2.8 times as long as 300 s; with 160 MB 2.0 times.
KEPT = 160 * 2**20


class Memory:
    """What was asked for last, by what it was made from, up to KEPT bytes."""

    def __init__(self) -> None:
        self._kept: OrderedDict[Hashable, tuple[Any, int]] = OrderedDict()
        self._bytes = 0

    def get(self, key: Hashable, make: Callable[[], Array]) -> Array:
        """The array of a key, made where it is not known; not to be written to."""

        def frozen() -> tuple[Array, int]:
            made = make()
            made.flags.writeable = False
            return made, made.nbytes

        return self._known(key, frozen)

    def columns(self, key: Hashable, make: Callable[[], Sequence[Column]]) -> Sequence[Column]:
        """Raw columns of a key, made where they are not known; not to be written to."""

        def sized() -> tuple[Sequence[Column], int]:
            made = make()
            return made, sum(values.nbytes for column in made for values, _ in column)

        return self._known(key, sized)

    def _known(self, key: Hashable, make: Callable[[], tuple[Any, int]]) -> Any:  # noqa: ANN401 - what make makes
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key][0]
        made, size = make()
        self._kept[key] = made, size
        self._bytes += size
        while self._bytes > KEPT and len(self._kept) > 1:
            self._bytes -= self._kept.popitem(last=False)[1][1]
        return made
