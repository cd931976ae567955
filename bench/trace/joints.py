"""Which columns of a log are of which joint: `q_0`, `elbow.position`, `/joint_states/elbow/position`, `pos_meas1`.

A name is cut into words. One of them is the signal, some may mean that it is measured or a set-point; the other
words are the joint, its name or its number. Joints are separated where names of the same making differ in them alone,
as `q_0` and `q_1` do: a file of one axis has no such names.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

from bench.trace.channel import Recording
from bench.trace.choose import axes_of
from bench.trace.signals import LETTERS, SI_UNITS, VAGUE, ColumnName, is_index, read_name, signal_of, unit_in_name

_WORD = re.compile(r"[^\W\d_]+|\d+")
#: Position of joints without another word, as LeRobot has it.
_STATE = re.compile(r"observations?[./]state[./]", re.IGNORECASE)


def by_joints(recording: Recording) -> Recording:
    """The same with the joint of each column of one as its axis, and its signal of it."""
    names: dict[int, tuple[str, ColumnName]] = {}
    for place, channel in enumerate(recording.channels):
        text = unit_in_name(channel.name)[0]
        if not channel.moments and not is_index(text):
            name = read_name(text)
            if name.joint and (signal := _signal(text, name)) is not None:
                names[place] = signal, name
    alike: defaultdict[tuple[str, frozenset[str], bool], set[str]] = defaultdict(set)
    for signal, name in names.values():
        if signal in ("position", "velocity"):
            alike[signal, name.words, name.joint.isdigit()].add(name.joint)
    joints = set().union(*(found for found in alike.values() if len(found) > 1))
    measured = {(signal, name.joint) for signal, name in names.values() if name.measured}
    channels = list(recording.channels)
    for place, (signal, name) in names.items():
        if name.joint in joints if channels[place].axis is None else name.joint == channels[place].axis:
            plain = name.measured or (signal, name.joint) not in measured  # `pos_meas1` next to `pos1`
            channels[place] = replace(channels[place], axis=name.joint, signal=signal if plain else None)
    return replace(recording, channels=tuple(channels))


def _signal(text: str, name: ColumnName) -> str | None:
    """Signal of a joint, or its time, by a column's name; None where there is none, or several."""
    told = name.told or ({LETTERS[name.letter]} if name.letter is not None and name.letter not in VAGUE else set())
    if not told and (_STATE.match(text) or _is_goal(name)):
        told = {"position"}
    signal = next(iter(told)) if len(told) == 1 and not name.foreign else None
    signal = f"{signal}_reference" if name.setpoint else signal
    return signal if signal in SI_UNITS or signal == "time" else None


def _is_goal(name: ColumnName) -> bool:
    """Whether a name is a joint's and a word alone that a servo's goal has, as `elbow.goal`."""
    return name.joint != "" and any(signal_of(word) == "position_reference" for word in name.words)


def named(recording: Recording, joints: Sequence[str]) -> Recording:
    """The same with its axes called as the joints of a robot - by their names, or their numbers in its order.

    A name may be within a longer one, as `elbow` in `robot0_elbow_joint`, where that is unique.
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
    """Joint of each axis with only one name."""
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
