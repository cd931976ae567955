"""What each check measures on recordings that are sound, beside its thresholds: `python -m tests.gate`."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import numpy as np
import typer

from bench.gate import effort, repairs, timing, velocity
from bench.gate.check import Seen
from bench.rig.rig import Rig
from bench.trace.trace import Trace
from tests.gate.clean import independent, public, real, shared_cases


def measures(trace: Trace, rig: Rig) -> Iterator[tuple[str, float]]:
    """What the checks hold against their thresholds, larger is worse."""
    seen = Seen(trace, rig)
    if {"position", "velocity"} <= set(trace.signals):
        both = velocity.compared(seen)
        assert both is not None
        ratio, _, remainder = both
        yield f"|ratio - 1| of speed (warned {velocity.WARNED}, refused {velocity.REFUSED})", abs(ratio - 1.0)
        yield f"remainder of speed (refused {velocity.REMAINDER})", remainder
    missing, again = repairs.damage_of(trace)
    share = (np.maximum(missing, 0).sum() + again.sum()) / len(trace)
    yield f"share of lost samples (refused {repairs.MOST}, without speed {repairs.MOST_BLIND})", share
    fitted = seen.balance()
    if fitted is not None:
        yield (
            f"effort unexplained (warned {1.0 - effort.WARNED:.2f}, refused {1.0 - effort.REFUSED:.2f})",
            (1.0 - fitted.by_position),
        )
    speeds = [seen.speed(part) for part in seen.stretches(timing.LEAST)]
    changes, alike = timing.followed(speeds)
    if changes > timing.CHANGES:
        yield (
            f"unlikeness of changes where they exceed {timing.CHANGES} (refused {1.0 - timing.ALIKE:.2f})",
            1.0 - alike,
        )
    yield f"change of speed a sample over its spread (refused {timing.CHANGES}, if unlike)", changes
    turned = float(np.percentile(np.abs(np.concatenate(speeds)), 95.0)) * trace.sample_period
    yield f"travel a sample (refused {timing.TURNED:.3g} rad below {timing.SLOW:g} Hz)", turned


def main() -> None:
    """Print the three worst sound recordings of each measure."""
    worst: dict[str, list[tuple[float, str]]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, trace, rig in chain(shared_cases(), real(), public(), independent(12, Path(folder))):
            for measure, value in measures(trace, rig):
                worst.setdefault(measure, []).append((value, name))
    for measure, values in worst.items():
        typer.echo(f"{measure}: " + ", ".join(f"{value:.3g} ({name})" for value, name in sorted(values)[:-4:-1]))


if __name__ == "__main__":
    typer.run(main)
