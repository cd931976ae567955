"""Motion in blocks of steps: what a simulation holds at once does not grow with the length of a recording."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from bench.arrays import Array

#: Bytes of inputs and states that a simulation holds at once.
BLOCK_BYTES = 8 * 2**20

#: Inputs of the actuator `drive` from one step to before another, (steps, inputs), made when they are needed.
Controls = Callable[[int, int], Array]


def blocks(steps: int, bytes_per_step: int) -> Iterator[tuple[int, int]]:
    """First step of each block and the one after its last."""
    size = max(1, BLOCK_BYTES // bytes_per_step)
    for start in range(0, steps, size):
        yield start, min(start + size, steps)


def samples_in(start: int, stop: int, every: int) -> tuple[slice, slice]:
    """Rows of the block of steps from `start` to `stop` that are samples, `every` steps apart, and which they are."""
    first, end = -(-start // every), -(-stop // every)
    return slice(first * every - start, max(stop - start, 0), every), slice(first, max(end, first))
