"""The signal that a column probably holds, judged by name, unit and values, with the reasons.

Columns of known vendors have the units of their manuals. Only a suggestion: the user decides and enters it in the rig's
`[trace.columns]`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.arrays import Array
from bench.trace.channel import Channel
from bench.trace.signals import SI_UNITS, is_index, signal_of, unit_of, wanted_units
from bench.units.conversion import is_unit, scale_of
from bench.units.grammar import UnitError

#: Words in column names, in the languages of drives, and letters of the field.
WORDS: dict[str, str] = {
    "time": r"time|zeit|temps|tempo|tiempo|timestamp|stamp|ms_today|clock|uhrzeit|t",
    "velocity": r"vel|velo|velocity|speed|spd|geschw\w*|drehzahl\w*|vitesse|velocidad|velocita|omega|rpm|erpm|"
    r"dq|qd|qdot|n_?ist|nact|v_?ist|606c|60:?6c|vact|actvel\w*|r63|r0063|vl|w",
    "position": r"pos|position\w*|angle|winkel|theta|enc|encoder|lage\w*|phi|weg|6064|actpos\w*|pl|q|x",
    "current": r"cur|curr|current|iq|i_q|isq|strom\w*|courant|corriente|amps?|r78|r0078|il|q_axis_current|i",
    "torque": r"torque|trq|tq|moment|drehmoment\w*|effort\w*|tau|couple|coppia|m_?ist|6077|r80|r0080|force|kraft",
    "voltage": r"volt\w*|spannung|uq|vq|vbus|udc|tension|u",
    "temperature": r"temp\w*|motor_temp",
    "acceleration": r"acc|accel\w*|beschl\w*",
}
_NAMED = {signal: re.compile(rf"(?:{words})\d*", re.I) for signal, words in WORDS.items()}
_REFERENCE = re.compile(
    r"set|soll\w*|ref|reference|cmd|command\w*|demand|target|goal|input|setpoint|sp|des|desired|consigne|"
    r"r62|r0062|607a|60ff",
    re.I,
)
_FOREIGN = re.compile(
    r"d_axis\w*|id|in|battery|supply|mos|frame|seq|state|status|flags?|mode|error|fault|checksum", re.I
)
_SPLIT = re.compile(r"[\s._/:()\[\],;|-]+|(?<=[a-z])(?=[A-Z])")
_ROUND = re.compile(r"(.*?)\s*[({]([^(){}]*)[)}]\s*|(.*?)[,/]\s+(\S+)")
#: Correlation from which a column is another's derivative, and samples that are looked at.
DERIVATIVE, ENOUGH = 0.9, 200_000
#: Characters of a name in which a unit is sought.
LONGEST_NAME = 200
#: Units of time without one, and the share by which a position and its velocity may miss each other in it.
TIMES, AGREEMENT = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0}, 0.1


@dataclass(frozen=True)
class VendorColumn:
    """A column of a vendor.

    Attributes:
        signal: that it holds.
        unit: by the manual; None if it depends on settings.
        note: the source, and what to check.
    """

    signal: str
    unit: str | None
    note: str


_DYNAMIXEL = "as Dynamixel's X series has it (control table in Robotis' e-manual); check your model's"
_ODRIVE = "as ODrive has it (docs.odriverobotics.com, API reference)"
_ROS = "as ROS has it (REP 103)"
_VESC = "as VESC Tool logs it"
_SINAMICS = "as SINAMICS has it (list manual)"
_CIA402 = "object of CiA 402"

#: Columns of drive vendors.
COLUMNS: dict[str, VendorColumn] = {
    "present_position": VendorColumn("position", "turn/4096", _DYNAMIXEL),
    "present_velocity": VendorColumn("velocity", "0.229 rpm", _DYNAMIXEL),
    "present_current": VendorColumn(
        "current", "2.69 mA", _DYNAMIXEL + ": 2.69 mA of XM and XH, 1 mA of XL330 and XC330"
    ),
    "pos_estimate": VendorColumn("position", "turn", _ODRIVE),
    "vel_estimate": VendorColumn("velocity", "turn/s", _ODRIVE),
    "iq_measured": VendorColumn("current", "A", _ODRIVE),
    "torque_estimate": VendorColumn("torque", "N*m", _ODRIVE),
    "input_pos": VendorColumn("position_reference", "turn", _ODRIVE),
    "input_vel": VendorColumn("velocity_reference", "turn/s", _ODRIVE),
    "%time": VendorColumn("time", "ns", "as rostopic echo -p writes it"),
    "position0": VendorColumn("position", "rad", _ROS),
    "velocity0": VendorColumn("velocity", "rad/s", _ROS),
    "effort0": VendorColumn("torque", "N*m", _ROS),
    "ms_today": VendorColumn("time", "ms", _VESC),
    "q_axis_current": VendorColumn("current", "A", _VESC),
    "erpm": VendorColumn("velocity", None, "electrical revolutions: write rpm/P with the motor's P pairs of poles"),
    "r63": VendorColumn("velocity", "rpm", _SINAMICS),
    "r80": VendorColumn("torque", "N*m", _SINAMICS),
    "r78": VendorColumn("current", "Arms", _SINAMICS),
    "0x6064": VendorColumn("position", None, f"{_CIA402}, position actual value; its unit is a setting of the drive"),
    "0x606c": VendorColumn("velocity", None, f"{_CIA402}, velocity actual value; its unit is a setting of the drive"),
    "0x6077": VendorColumn("torque", "permille", f"{_CIA402}, torque actual value in permille of rated_torque"),
}


@dataclass(frozen=True)
class Guess:
    """A signal that a column may hold.

    Attributes:
        signal: as `[trace.columns]` names it.
        unit: of the column; None if only the user knows.
        why: the reasons.
        weight: of the reasons.
    """

    signal: str
    unit: str | None
    why: tuple[str, ...]
    weight: float


def likely_signals(channels: Sequence[Channel]) -> dict[int, Guess]:
    """What each channel is likely to be, by its place in the file; no two of an axis are the same signal."""
    numeric = {
        place: channel for place, channel in enumerate(channels) if channel.defect is None and channel.values.size > 1
    }
    with np.errstate(over="ignore", invalid="ignore"):  # implausible magnitudes give no reasons
        times = [place for place, channel in numeric.items() if _rises(channel.values)]
        derived = _derivatives(numeric, times)
    found = [
        (guess, place)
        for place, channel in numeric.items()
        for guess in _guesses(channel, derived.get(place), place in times)
    ]
    found.sort(key=lambda pair: -pair[0].weight)
    given: dict[int, Guess] = {}
    taken: set[tuple[str, str | None]] = set()
    for guess, place in found:
        key = (guess.signal, channels[place].axis)
        if place not in given and key not in taken:
            given[place] = guess
            taken.add(key)
    with np.errstate(over="ignore", invalid="ignore"):
        return _with_time_unit(given, channels)


def _with_time_unit(given: dict[int, Guess], channels: Sequence[Channel]) -> dict[int, Guess]:
    """A time without a unit takes the one in which position and velocity, both with theirs, agree."""
    of = {guess.signal: (place, guess) for place, guess in given.items()}
    if not {"time", "position", "velocity"} <= set(of):
        return given
    place, time = of["time"]
    if time.unit is not None or channels[place].moments:
        return given
    angle, speed = (_in_si(channels[of[name][0]], of[name][1]) for name in ("position", "velocity"))
    ticks = channels[place].values[:ENOUGH]
    if angle is None or speed is None or not angle.size == speed.size == ticks.size:
        return given
    step = np.diff(angle)
    travelled = 0.5 * (speed[1:] + speed[:-1]) * np.diff(ticks)
    plain = np.abs(step) < 0.2 * np.ptp(angle)
    power = float(travelled[plain] @ travelled[plain])
    second = float(travelled[plain] @ step[plain]) / power if power > 0.0 else 0.0
    for unit, factor in TIMES.items():
        if abs(second / factor - 1.0) < AGREEMENT:
            why = (*time.why, f"position and velocity agree in {unit}")
            return {**given, place: replace(time, unit=unit, why=why)}
    return given


def _in_si(channel: Channel, guess: Guess) -> Array | None:
    if guess.unit is None:
        return None
    try:
        return channel.values[:ENOUGH] * scale_of(guess.unit, wanted_units(guess.signal)).factor
    except UnitError:
        return None


def _guesses(channel: Channel, derived: tuple[str, str] | None, rises: bool) -> list[Guess]:
    """Signals that a channel may be."""
    unit = written_unit_of(channel)
    own = signal_of(channel.name)
    parts = [part for part in _SPLIT.split(channel.name) if part]
    compact = channel.name.strip().rsplit(".", 1)[-1]
    foreign = any(_FOREIGN.fullmatch(part) for part in parts)
    guesses = []
    for signal in ("time", *WORDS):
        why, weight = [], 0.0
        if signal == "time" and not rises:
            continue
        if channel.moments and signal == "time":
            why, weight = ["holds moments"], 4.0
        if own == signal:
            why.append(f"is called '{channel.name}'")
            weight += 3.0
        elif _NAMED[signal].fullmatch(compact) or any(_NAMED[signal].fullmatch(part) for part in parts):
            why.append(f"'{channel.name}' speaks of {signal}")
            weight += 1.0 if foreign else 2.0
        fits = _fits(signal, unit)
        if fits:
            why.append(f"stands in {unit}")
            weight += 1.5
        elif fits is False:
            continue
        if derived is not None and derived[0] == signal:
            why.append(derived[1])
            weight += 1.5
        if signal == "time" and why:
            why.append("rises steadily")
            weight += 1.0
        if weight >= 1.5:
            guesses.append(_guess(signal, channel, unit if fits else None, parts, why, weight))
    return guesses


def _guess(signal: str, channel: Channel, unit: str | None, parts: list[str], why: list[str], weight: float) -> Guess:
    reference = f"{signal}_reference"
    if reference in SI_UNITS and any(_REFERENCE.fullmatch(part) for part in parts):
        why, signal, weight = [*why, "is a set-point by its name"], reference, weight - 0.25
    if unit is None and not channel.moments:
        known = vendor_column(channel.name)
        if known is not None and known.signal == signal:
            return Guess(signal, known.unit, (*why, known.note), weight + 0.5)
    return Guess(signal, unit, tuple(why), weight)


def written_unit_of(channel: Channel) -> str | None:
    """Unit of a channel from its head or, in round brackets or behind a comma, its name."""
    unit = unit_of(channel.unit)
    if unit is not None or channel.moments:
        return unit
    match = _ROUND.fullmatch(channel.name) if len(channel.name) <= LONGEST_NAME else None
    inside = (match[2] or match[4] or "").strip() if match else ""
    return inside if inside and is_unit(inside) else None


def _fits(signal: str, unit: str | None) -> bool | None:
    """Whether a signal may stand in a unit; None where there is none, or only the user knows."""
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
    return (steps.size > 0 and bool((steps >= 0).all()) and float(np.median(steps)) > 0.0) or bool(
        steps.size and (steps >= 0).all() and steps.any() and (steps > 0).mean() > 0.5
    )


def _derivatives(numeric: Mapping[int, Channel], times: Sequence[int]) -> dict[int, tuple[str, str]]:
    """Place -> signal and reason, of pairs of which one is the other's derivative."""
    found: dict[int, tuple[str, str]] = {}
    moving = {place: channel for place, channel in numeric.items() if place not in times and not is_index(channel.name)}
    rates = {place: _rate(channel.values[:ENOUGH]) for place, channel in moving.items()}
    for place, rate in rates.items():
        for other, channel in moving.items():
            if other == place or channel.values.size != numeric[place].values.size or rate is None:
                continue
            if abs(_correlation(rate, channel.values[:ENOUGH])) > DERIVATIVE:
                found[place] = ("position", f"its derivative is '{channel.name}'")
                found[other] = ("velocity", f"is the derivative of '{numeric[place].name}'")
    return found


def _rate(values: Array) -> Array | None:
    """Smoothed derivative of a column a sample, leaps of a wrapped one left out."""
    if values.size < 64 or not np.isfinite(values).all() or not np.ptp(values):
        return None
    rate = np.gradient(values)
    rate[np.abs(rate) > 0.2 * np.ptp(values)] = 0.0
    return np.convolve(rate, np.ones(9) / 9.0, mode="same")


def _correlation(one: Array, other: Array) -> float:
    smooth = np.convolve(np.nan_to_num(other), np.ones(9) / 9.0, mode="same")
    spread = float(np.std(one) * np.std(smooth))
    return float(np.mean((one - one.mean()) * (smooth - smooth.mean()))) / spread if spread > 0.0 else 0.0


def vendor_column(name: str) -> VendorColumn | None:
    """The column of this name; None if no known vendor has one."""
    plain = name.strip().lower()
    for key in (plain, plain.rsplit(".", 1)[-1], plain.split("[")[0].split(":")[0].replace("r00", "r")):
        if key in COLUMNS:
            return COLUMNS[key]
    return None
