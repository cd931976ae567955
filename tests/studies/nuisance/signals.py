"""Columns of a recording, and the electronics that make them of what the axis did."""

from __future__ import annotations

import gzip
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bench.validation.independent.rig import Axis
from bench.validation.independent.sensors import rounded

Array = np.ndarray

#: Of the exact recording: the drive's control period - s.
FINE = 250e-6
#: Steps of the encoder in a turn.
COUNTS = 2**18
#: White noise: of the speed over top speed, of the current over its peak.
SPEED_NOISE, CURRENT_NOISE = 1e-4, 2e-3
#: Unit in the file, and how many of it make one of SI.
UNITS = {"position": ("deg", float(np.degrees(1.0))), "velocity": ("deg/s", float(np.degrees(1.0)))}
UNITS |= {f"{name}_reference": unit for name, unit in UNITS.items()} | {"current": ("mA", 1e3)}


@dataclass(frozen=True)
class Signals:
    """A recording's columns.

    Attributes:
        time: - s - (n,).
        columns: by name: position, velocity, current, and references where recorded - SI - (n,) each.
    """

    time: Array
    columns: Mapping[str, Array]

    def __getitem__(self, name: str) -> Array:
        return self.columns[name]

    def but(self, **columns: Array) -> Signals:
        """The same with other columns."""
        return replace(self, columns={**self.columns, **columns})

    def without(self, *names: str) -> Signals:
        """The same without some columns."""
        return replace(self, columns={name: values for name, values in self.columns.items() if name not in names})

    def rows(self, index: Array) -> Signals:
        """Some rows, stamps and all; an index or a mask."""
        return Signals(self.time[index], {name: values[index] for name, values in self.columns.items()})

    def at(self, time: Array) -> Signals:
        """What the signals were at other times, linear between; stamped with those times - s."""
        return Signals(time, {name: np.interp(time, self.time, values) for name, values in self.columns.items()})

    def stamped(self, time: Array) -> Signals:
        """The same rows with other stamps - s."""
        return replace(self, time=time)

    def renumbered(self) -> Signals:
        """Rows stamped one period apart, as if none were missing or doubled."""
        period = float(np.median(np.diff(self.time)))
        return self.stamped(self.time[0] + period * np.arange(self.time.size))


def sampled(fine: Signals, period: float) -> Signals:
    """Every so many of the exact samples - s."""
    return fine.rows(np.arange(0, fine.time.size, round(period / FINE)))


def noisy(signals: Signals, axis: Axis, rng: np.random.Generator) -> Signals:
    """Noise and steps of sound electronics."""
    hiss = rng.standard_normal((2, signals.time.size))
    return signals.but(
        position=rounded(signals["position"], 2.0 * np.pi / COUNTS),
        velocity=signals["velocity"] + SPEED_NOISE * axis.top_speed * hiss[0],
        current=signals["current"] + CURRENT_NOISE * axis.peak_current * hiss[1],
    )


def write_csv(signals: Signals, path: Path) -> None:
    """Canonical CSV in ms, deg and mA; cells that are not finite are left empty."""
    header, columns = ["time [ms]"], [signals.time * 1e3]
    for name, values in signals.columns.items():
        unit, factor = UNITS[name]
        header.append(f"{name} [{unit}]")
        columns.append(values * factor)
    with gzip.open(path, "wt", encoding="utf-8", compresslevel=1) as file:
        file.write(",".join(header) + "\n")
        for row in np.column_stack(columns).tolist():
            file.write(",".join("" if cell != cell else f"{cell:.10g}" for cell in row) + "\n")
