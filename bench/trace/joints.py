"""Which columns of a log are of which joint: `q_0`, `elbow.position`, `/joint_states/elbow/position`, `pos_meas1`.

A name is cut into words. One of them tells the signal, some may tell that it is measured or a set-point; what is left
is the joint, by its name or its number. Joints are taken apart where names of the same making differ in them alone, as
`q_0` and `q_1` do: a file of one axis has no such names.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

from bench.trace.channel import Recording
from bench.trace.choose import axes_of
from bench.trace.signals import REFERENCE, SI_UNITS, WORDS, is_index, signal_of, unit_in_name

_SIGNALS = {signal: re.compile(words, re.IGNORECASE) for signal, words in WORDS.items()}
_MEASURED = re.compile(r"meas|measured|act|actual|present|feedback|fb|raw", re.IGNORECASE)
#: Where a log keeps its joints: words that tell no joint from another.
_PLACE = re.compile(r"observations?|obs|states?|joint_?states?|joints|field|data|msg|log", re.IGNORECASE)
_PART, _WORD = re.compile(r"[\s./()\[\],;:]+"), re.compile(r"[^\W\d_]+|\d+")
#: Letters of the field that are a signal only beside a number, as `x1`: `tip_x` is no angle of a joint `tip`.
_LETTERS = frozenset("xwiut")
#: Position of joints without another word, as LeRobot has it.
_STATE = re.compile(r"observations?[./]state[./]", re.IGNORECASE)


@dataclass(frozen=True)
class _Name:
    """What the name of a column says: its signal, its joint, and the words that say the signal."""

    signal: str
    joint: str
    words: frozenset[str]
    measured: bool


def by_joints(recording: Recording) -> Recording:
    """The same with the joint of each column of one as its axis, and the signal it holds of it."""
    names = {
        place: name
        for place, channel in enumerate(recording.channels)
        if not channel.moments and (name := _read(unit_in_name(channel.name)[0])) is not None
    }
    alike: defaultdict[tuple[str, frozenset[str], bool], set[str]] = defaultdict(set)
    for name in names.values():
        if name.signal in ("position", "velocity"):
            alike[name.signal, name.words, name.joint.isdigit()].add(name.joint)
    joints = set().union(*(found for found in alike.values() if len(found) > 1))
    measured = {(name.signal, name.joint) for name in names.values() if name.measured}
    channels = list(recording.channels)
    for place, name in names.items():
        if name.joint in joints if channels[place].axis is None else name.joint == channels[place].axis:
            plain = name.measured or (name.signal, name.joint) not in measured  # `pos_meas1` beside `pos1`
            channels[place] = replace(channels[place], axis=name.joint, signal=name.signal if plain else None)
    axes = set(axes_of(channels))
    for place, channel in enumerate(channels):
        whose = channel.name.rpartition(".")[0]  # times of one axis, as `run.2.t` are of `run.2`
        if channel.axis is None and whose in axes and signal_of(channel.name) == "time":
            channels[place] = replace(channel, axis=whose)
    return replace(recording, channels=tuple(channels))


def _read(text: str) -> _Name | None:
    """What a name says; None where it tells no signal, or two, or no joint."""
    if len(text) > 200 or is_index(text):
        return None
    signal_of_word: dict[str, str] = {}
    key, said, reference, measured = list[str](), set[str](), False, False
    for part in filter(None, _PART.split(text)):
        if _PLACE.fullmatch(part):
            said.add(part.lower())
            continue
        words = _WORD.findall(part)
        alone = sum(not word.isdigit() for word in words) == 1
        signals = {word: found for word in words if (found := _signal(word, alone)) is not None}
        wanted = {word for word in words if REFERENCE.fullmatch(word)} if signals or alone else set()
        seen = {word for word in words if _MEASURED.fullmatch(word)} if signals or alone else set()
        signal_of_word |= {word.lower(): signal for word, signal in signals.items()}
        reference, measured = reference or bool(wanted), measured or bool(seen)
        gone = {*signals, *wanted, *seen}
        said |= {word.lower() for word in gone}
        left = [word for word in words if word not in gone]
        if left:
            key.append("_".join(left) if gone else part.strip("_"))
    signals = set(signal_of_word.values())
    if signals & {"position", "velocity"}:
        signals.discard("current")  # the current one
    state = "position" if not signals and _STATE.match(text) else None
    signal = next(iter(signals)) if len(signals) == 1 else state
    signal = f"{signal}_reference" if reference else signal
    if signal not in SI_UNITS or not key:
        return None
    return _Name(signal, ".".join(key), frozenset(said), measured)


def _signal(word: str, alone: bool) -> str | None:
    """Signal that a word tells; None where it tells none, or several."""
    if word.isdigit() or (word.lower() in _LETTERS and not alone):
        return None
    found = [signal for signal, pattern in _SIGNALS.items() if pattern.fullmatch(word)]
    return found[0] if len(found) == 1 else None


def named(recording: Recording, joints: Sequence[str]) -> Recording:
    """The same with its axes called as the joints of a robot - by their names, or their numbers in its order.

    A name may stand within a longer one, as `elbow` in `robot0_elbow_joint`, where that leaves no choice.
    """
    axes = axes_of(recording.channels)
    found = _by_name(axes, joints)
    notes = [f"{axis} is {joint}" for axis, joint in found.items() if axis != joint]
    ending = {axis: int(match[0]) for axis in axes if (match := re.search(r"\d+$", axis))}
    numbers = sorted([axis for axis in ending if axis.isdigit()] or ending, key=lambda axis: ending[axis])
    if not found and len(numbers) == len(joints):
        found = dict(zip(numbers, joints, strict=True))
        notes = [f"joints {numbers[0]} to {numbers[-1]} are taken in the robot's order: {', '.join(joints)}"]
    channels = tuple(
        replace(channel, axis=found.get(channel.axis, channel.axis)) if channel.axis is not None else channel
        for channel in recording.channels
    )
    return replace(recording, channels=channels, notes=(*recording.notes, *notes))


def _by_name(axes: Sequence[str], joints: Sequence[str]) -> dict[str, str]:
    """Joint of each axis that one name leaves no choice of."""
    found: dict[str, str] = {}
    for alike in (str.__eq__, lambda axis, joint: _plain(axis) == _plain(joint), _within):
        left = [axis for axis in axes if axis not in found]
        free = [joint for joint in joints if joint not in found.values()]
        pairs = [(axis, joint) for axis in left for joint in free if alike(axis, joint)]
        found |= {
            axis: joint
            for axis, joint in pairs
            if sum(axis == one for one, _ in pairs) == 1 and sum(joint == one for _, one in pairs) == 1
        }
    return found


def _plain(name: str) -> str:
    return "".join(_WORD.findall(name)).lower()


def _within(axis: str, joint: str) -> bool:
    """Whether the words of one name stand in a row in the other."""
    one, other = ([word.lower() for word in _WORD.findall(name)] for name in (axis, joint))
    short, long = sorted((one, other), key=len)
    return not all(map(str.isdigit, short)) and any(
        long[k : k + len(short)] == short for k in range(len(long) - len(short) + 1)
    )
