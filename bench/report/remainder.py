"""What a diagnosis leaves unexplained: its shape, the nearest suspects, what speaks against them, what would decide."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bench.arrays import Array
from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.where import Where
from bench.names import words
from bench.report.numbers import coordinate_word, number, share

#: A region is narrow, or near zero, within this share of what was seen; a trend and a wave are clear from this share.
NARROW, CLEAR = 0.15, 0.6
#: Suspects that are told.
NEAREST = 2
#: By coordinate: what to record, and the command for it.
DECIDES = {
    "position": ("the whole travel slowly, both ways: what stays at its place is the axis'", "diagnose slow.csv"),
    "velocity": ("steady speeds, a recording each: they draw friction over speed", "friction at*.csv"),
    "reversal": ("slow reversals with the position, sampled faster: they show how it breaks away", "diagnose slow.csv"),
    "time": ("the same motion cold and warm: what comes back is no warming", "diagnose cold.csv warm.csv"),
    "direction": ("the same motion with the axis turned over: what turns with it is gravity", "diagnose turned.csv"),
    "frequency": ("another speed: a frequency that moves along is of the shaft, one that stays of drive or frame",
                  "diagnose faster.csv"),
}  # fmt: skip
OTHERWISE = (
    "half and twice the acceleration: what grows with torque is of motor, gear or sensor",
    "diagnose half.csv twice.csv",
)


def remainder(found: Diagnosis) -> Iterator[str]:
    """Sentences about what is left; none where nothing is."""
    if not found.unexplained_where:
        return
    shapes = [f"{shape(one)} ({share(one.share)} of it)" for one in found.unexplained_where]
    yield f"What is left: {'; '.join(shapes)}."
    parts = [(one.beside if found.effects else one.alone, one) for one in found.considered if not one.taken]
    near = sorted(((part, one) for part, one in parts if part), key=lambda pair: -pair[0])[:NEAREST]
    nearest = [f"{words(one.effect.name)}, {share(part)} of it, but {one.reason}" for part, one in near]
    yield f"Nearest of the catalogue: {'; '.join(nearest)}." if nearest else "No effect of the catalogue comes near it."
    record, command = DECIDES.get(found.unexplained_where[0].coordinate, OTHERWISE)
    yield f"To decide, record {record}: bench {command} --rig RIG."


def shape(one: Where) -> str:
    """How what is left lies over a coordinate, in words."""
    (low, high), centres, name = one.region, one.centres, coordinate_word(one.coordinate, one.unit)
    between = f"between {number(low, digits=3)} and {number(high, one.unit, 3)}"
    reach, size = float(np.ptp(centres)), float(np.abs(centres).max())
    narrow = high - low <= NARROW * reach
    match one.coordinate:
        case "frequency":
            return f"an oscillation of {number(0.5 * (low + high), one.unit, 3)}"
        case "direction":
            return "it differs between the directions"
        case "reversal" if high <= NARROW * reach:
            return f"spikes at each breakaway, within {number(high, one.unit, 3)} of a reversal"
        case "velocity" if max(abs(low), abs(high)) <= NARROW * size:
            return f"around standstill, {between}"
        case "time" if abs(trend := float(np.corrcoef(centres, np.abs(one.means))[0, 1])) >= CLEAR:
            return "it grows with time" if trend > 0.0 else "it fades with time"
        case "position" if (length := _wave(centres, one.means)) > 0.0:
            return f"a wave of {number(length, one.unit, 3)}"
        case _ if narrow:
            return f"at one {name}, {between}"
    return f"it changes with {name}, most {between}"


def _wave(x: Array, y: Array) -> float:
    """Length of the wave that is most of y (b,) over x (b,); 0 where none is."""
    y, reach, best = y - y.mean(), float(np.ptp(x)), (0.0, 0.0)
    for waves in range(1, x.size // 4 + 1):
        phase = 2.0 * np.pi * waves * x / reach
        columns = np.column_stack([np.sin(phase), np.cos(phase)])
        left = y - columns @ np.linalg.lstsq(columns, y, rcond=None)[0]
        best = max(best, (1.0 - float(left @ left) / max(float(y @ y), 1e-300), reach / waves))
    return best[1] if best[0] >= CLEAR else 0.0
