"""Which signal a column probably has: the one place that decides it, from name, unit and samples.

Reasons are weighed: a well-known name, words in it, the dimension of the unit, a column that is another's derivative. A
unit rules out every signal of another dimension, and a word for a signal rules out all others.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from bench.arrays import Array
from bench.trace.channel import Channel
from bench.trace.signals import (
    LETTERS,
    RELATIVE,
    SI_UNITS,
    VAGUE,
    WORDS,
    ColumnName,
    is_index,
    read_name,
    signal_of,
    unit_in_name,
    unit_of,
    wanted_units,
)
from bench.units.conversion import scale_of
from bench.units.grammar import UnitError

#: Signals that only their own names stand for.
BY_NAME = "supply_voltage", "load_position"
#: Correlation from which a column is another's derivative; samples and columns that are compared.
DERIVATIVE, ENOUGH, MOST = 0.9, 200_000, 64
#: Weights of reasons: a well-known name, one that a joint's name gives, a word, a unit, a derivative (a current is one
#: of a speed, too), an uncertain letter, being measured. From SURE on a column is read, and from MAYBE on where no
#: other is; a derivative alone is a suggestion.
KNOWN, OF_JOINT, WORD, UNIT, DERIVED, LETTER, MEASURED = 3.5, 2.5, 2.0, 1.5, 1.25, 0.75, 0.5
SURE, MAYBE = 2.0, 1.5

_DYNAMIXEL = "as Dynamixel's X series has it (control table in Robotis' e-manual); check your model's"
_ODRIVE = "as ODrive has it (docs.odriverobotics.com, API reference)"
_ROS = "as ROS has it (REP 103)"
_VESC = "as VESC Tool logs it"
_SINAMICS = "as SINAMICS has it (list manual)"
_CIA402 = "object of CiA 402"

#: Columns of drive vendors: the signal, its unit by the manual - None if it depends on settings -, and the source with
#: what to check.
COLUMNS: dict[str, tuple[str, str | None, str]] = {
    "goal_position": ("position_reference", "turn/4096", _DYNAMIXEL),
    "goal_velocity": ("velocity_reference", "0.229 rpm", _DYNAMIXEL),
    "present_position": ("position", "turn/4096", _DYNAMIXEL),
    "present_velocity": ("velocity", "0.229 rpm", _DYNAMIXEL),
    "present_current": ("current", "2.69 mA", _DYNAMIXEL + ": 2.69 mA of XM and XH, 1 mA of XL330 and XC330"),
    "pos_estimate": ("position", "turn", _ODRIVE),
    "vel_estimate": ("velocity", "turn/s", _ODRIVE),
    "iq_measured": ("current", "A", _ODRIVE),
    "torque_estimate": ("torque", "N*m", _ODRIVE),
    "input_pos": ("position_reference", "turn", _ODRIVE),
    "input_vel": ("velocity_reference", "turn/s", _ODRIVE),
    "%time": ("time", "ns", "as rostopic echo -p writes it"),
    "position0": ("position", "rad", _ROS),
    "velocity0": ("velocity", "rad/s", _ROS),
    "effort0": ("torque", "N*m", _ROS),
    "ms_today": ("time", "ms", _VESC),
    "q_axis_current": ("current", "A", _VESC),
    "erpm": ("velocity", "erpm", _VESC),
    "r62": ("velocity_reference", "rpm", _SINAMICS),
    "r63": ("velocity", "rpm", _SINAMICS),
    "r80": ("torque", "N*m", _SINAMICS),
    "r78": ("current", "Arms", _SINAMICS),
    "6064": ("position", None, f"{_CIA402}, position actual value; its unit is a setting of the drive"),
    "606c": ("velocity", None, f"{_CIA402}, velocity actual value; its unit is a setting of the drive"),
    "6077": ("torque", "permille", f"{_CIA402}, torque actual value in permille of rated_torque"),
    "607a": ("position_reference", None, f"{_CIA402}, target position; its unit is a setting of the drive"),
    "60ff": ("velocity_reference", None, f"{_CIA402}, target velocity; its unit is a setting of the drive"),
}

#: By signal, what speaks for it.
Reasons = dict[str, list[tuple[float, str]]]


@dataclass(frozen=True)
class LikelySignal:
    """A signal that a column may hold.

    Attributes:
        signal: as `[trace.columns]` names it.
        unit: of the column; None where neither its head nor its name has one that the signal may have.
        usual: unit that the vendor of such a column documents.
        known: whether its whole name is a well-known one, or a joint's.
        why: the reasons.
        weight: of the reasons.
    """

    signal: str
    unit: str | None
    usual: str | None
    known: bool
    why: tuple[str, ...]
    weight: float


@np.errstate(over="ignore", invalid="ignore")  # implausible magnitudes give no reasons
def candidates(channels: Sequence[Channel]) -> dict[Channel, LikelySignal]:
    """The signal that each column most probably has, the best columns first; without those that fit none."""
    names = {channel: read_name(_bare(channel)) for channel in channels}
    bare = all(_written_unit(channel) is None or _fits("time", _written_unit(channel)) for channel in channels)
    reasons = {channel: _reasons(channel, name, bare) for channel, name in names.items()}
    for signal, channel, reason in _by_motion(names, reasons):
        reasons[channel][signal].append((DERIVED, reason))
    found = {channel: _candidate(channel, names[channel], reasons[channel]) for channel in channels}
    kept = {channel: one for channel, one in found.items() if one is not None and one.weight >= DERIVED}
    alike = [(one.signal, channel.axis) for channel, one in kept.items()]
    for channel, one in list(kept.items()):
        several = alike.count((one.signal, channel.axis)) > 1
        if several and not one.known and channel.values.size and not np.ptp(channel.values):
            kept[channel] = replace(one, why=(*one.why, "never changes"), weight=one.weight - WORD)
    return dict(sorted(kept.items(), key=lambda pair: -pair[1].weight))


def _bare(channel: Channel) -> str:
    """Name of a channel without a unit in it."""
    return unit_in_name(channel.name)[0]


def _written_unit(channel: Channel) -> str | None:
    """Unit of a channel from its head or its name."""
    return unit_of(channel.unit) or (None if channel.moments else unit_in_name(channel.name)[1])


def _vendor_column(name: str) -> tuple[str, str | None, str] | None:
    """The column of this name in COLUMNS; None if no known vendor has one."""
    plain = name.strip().lower()
    last = plain.rsplit(".", 1)[-1]
    keys = (plain, last, last.removeprefix("0x").split(":")[0], plain.split("[")[0].split(":")[0].replace("r00", "r"))
    return next((COLUMNS[key] for key in keys if key in COLUMNS), None)


def _stated(channel: Channel, name: ColumnName) -> tuple[str | None, bool]:
    """Signal that a well-known name, a joint's or a vendor's states; and whether it is one of the first two."""
    exact, vendor = signal_of(_bare(channel)), _vendor_column(_bare(channel))
    stated = exact or channel.signal or (vendor[0] if vendor is not None else None)
    reference = f"{stated}_reference"
    return reference if name.setpoint and reference in SI_UNITS else stated, bool(exact or channel.signal)


def _reasons(channel: Channel, name: ColumnName, bare: bool) -> Reasons:
    """What speaks for each signal that name and unit admit, or its set-point; `bare`: no column has a unit."""
    unit, (stated, known) = _written_unit(channel), _stated(channel, name)
    told = name.told if stated is None else {stated.removesuffix("_reference")}
    if name.foreign or (is_index(channel.name) and unit is None and not told):
        return {}
    if "torque" in told and unit is not None and not _fits("torque", unit) and _fits("force", unit):
        told = {"force"}
    found: Reasons = {}
    for signal in (*WORDS, "force", *BY_NAME):
        fits = _fits(signal, unit)
        if signal in BY_NAME and signal_of(_bare(channel)) != signal:
            continue
        if (told and signal not in told) or (fits is False and not known):
            continue
        if name.supply and signal in ("current", "voltage") and not known:
            continue
        rises = signal == "time" and _rises(channel.values)
        if signal == "time" and not (rises or told or channel.moments):
            continue
        plain = bool(fits or bare or (fits is None and unit is not None))
        found[signal] = [*_of_name(signal, channel, name, told, plain), *_of_unit(signal, unit, fits)]
        if signal == "time" and channel.moments:
            found[signal].append((4.0, "contains moments"))
        if rises and (found[signal] or _is_nameless(name)):
            found[signal].append((1.0 if found[signal] else DERIVED, "rises steadily"))
    return found


def _of_name(
    signal: str, channel: Channel, name: ColumnName, told: frozenset[str] | set[str], plain: bool
) -> Iterator[tuple[float, str]]:
    vendor = _vendor_column(_bare(channel))
    if signal_of(_bare(channel)) is not None:
        yield KNOWN, f"is called '{channel.name}'"
    elif channel.signal is not None:
        yield OF_JOINT, f"is of {channel.axis}"
    elif signal in told:
        yield WORD, f"'{channel.name}' has a word for {signal}"
    elif name.letter is not None and LETTERS[name.letter] == signal:
        yield (WORD if plain and name.letter not in VAGUE else LETTER), f"'{channel.name}' has the letter of {signal}"
    if vendor is not None and unit_of(channel.unit) is None:
        yield MEASURED, vendor[2]
    elif name.measured and signal_of(_bare(channel)) is None:
        yield MEASURED, "is measured by its name"


def _of_unit(signal: str, unit: str | None, fits: bool | None) -> Iterator[tuple[float, str]]:
    if fits and unit is not None and scale_of(unit, wanted_units(signal)).unit != RELATIVE:
        yield UNIT, f"is in {unit}"


def _candidate(channel: Channel, name: ColumnName, reasons: Reasons) -> LikelySignal | None:
    """What a channel is by the most of its reasons; None without any, and of a set-point that no trace has."""
    signal = max(reasons, key=lambda signal: sum(weight for weight, _ in reasons[signal]), default=None)
    if signal is None:
        return None
    unit, vendor, (stated, known) = _written_unit(channel), _vendor_column(_bare(channel)), _stated(channel, name)
    weight, why = sum(weight for weight, _ in reasons[signal]), [text for _, text in reasons[signal]]
    own = unit if _fits(signal, unit) else None
    if name.setpoint or str(stated).endswith("_reference"):
        signal = f"{signal}_reference"
        why.append("is a set-point by its name")
    if signal not in SI_UNITS and signal != "time":
        return None
    usual = vendor[1] if vendor is not None and unit is None and not channel.moments else None
    return LikelySignal(signal, own, usual, known, tuple(why), weight)


@cache
def _fits(signal: str, unit: str | None) -> bool | None:
    """Whether a signal may be in a unit; None where there is none, or only the user can state it."""
    if unit is None:
        return None
    try:
        scale_of(unit, wanted_units(signal))
    except UnitError as error:
        return None if "may mean" in error.found or "counts" in error.found else False
    return True


def _rises(values: Array) -> bool:
    steps = np.diff(values[:ENOUGH])
    steps = steps[np.isfinite(steps)]
    return steps.size > 0 and bool((steps >= 0).all()) and float(np.median(steps)) > 0.0


def _is_nameless(name: ColumnName) -> bool:
    return not name.told and name.letter is None


def _by_motion(
    names: Mapping[Channel, ColumnName], reasons: Mapping[Channel, Reasons]
) -> list[tuple[str, Channel, str]]:
    """Of the columns of each axis the two of which one is most plainly the other's derivative, and one without a name
    that inertia and friction of that motion explain; with the reason."""
    groups: dict[tuple[str | None, int], list[Channel]] = {}
    for channel, of in reasons.items():
        if not {"position", "velocity"}.isdisjoint(of) and not names[channel].setpoint and channel.values.size >= 64:
            groups.setdefault((channel.axis, channel.values.size), []).append(channel)
    found: list[tuple[str, Channel, str]] = []
    for group in groups.values():
        rates, levels = _comparable(group[:MOST])
        best, pair = DERIVATIVE, None
        for one, rate in rates.items():
            for other, level in levels.items():
                possible = other is not one and "position" in reasons[one] and "velocity" in reasons[other]
                if possible and (alike := float(rate @ level)) > best:
                    best, pair = alike, (one, other)
        if pair is None:
            continue
        found.append(("position", pair[0], f"its derivative is '{pair[1].name}'"))
        found.append(("velocity", pair[1], f"is the derivative of '{pair[0].name}'"))
        free = {one for one, name in names.items() if _is_nameless(name) or LETTERS.get(name.letter or "") == "torque"}
        others = {one: level for one, level in levels.items() if one not in pair and one in free}
        effort = _explained_by(rates[pair[1]], levels[pair[1]], others)
        if effort is not None:
            found.append(("torque", effort, f"accelerates '{pair[1].name}', so it is a torque, or a current"))
    return found


def _explained_by(rate: Array, level: Array, others: Mapping[Channel, Array]) -> Channel | None:
    """The column that a speed's slope and friction explain best; None where the speed alone explains it, too."""
    best, found = DERIVATIVE, None
    design = np.stack([level, np.sign(level), rate], axis=1)
    for one, values in others.items():
        shares = [
            float(values @ part @ np.linalg.lstsq(part, values, rcond=None)[0]) for part in (design[:, :2], design)
        ]
        if shares[0] < DERIVATIVE and shares[1] > best:
            best, found = shares[1], one
    return found


def _comparable(channels: Sequence[Channel]) -> tuple[dict[Channel, Array], dict[Channel, Array]]:
    """Smoothed derivatives and values of columns, each of mean 0 and norm 1; without those that never change."""
    rates, levels = dict[Channel, Array](), dict[Channel, Array]()
    for channel in channels:
        values = channel.values[:ENOUGH]
        if not np.isfinite(values).all() or not np.ptp(values) or _rises(values):
            continue
        rate = np.gradient(values)
        rate[np.abs(rate) > 0.2 * np.ptp(values)] = 0.0  # where it wraps
        for found, signal in ((rates, rate), (levels, values)):
            smooth = np.convolve(signal, np.ones(9) / 9.0, mode="same")
            smooth = smooth - smooth.mean()
            size = float(np.linalg.norm(smooth))
            if 0.0 < size < np.inf:
                found[channel] = smooth / size
    return rates, levels
