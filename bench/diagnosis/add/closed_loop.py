"""Velocity gap under the drive of the rig, from the references of a recording: a prediction without tracking.

Feedback hides most effects here - the drive makes good what the model lacks - but for what happens in the drive itself
it is the only place to look: a voltage limit acts before the recorded current, with which the held model is fed.
"""

from __future__ import annotations

from bench.arrays import rms
from bench.diagnosis.add.extension import Extension
from bench.diagnosis.recordings import Recordings
from bench.errors import BenchError
from bench.plant.follow import follow_references
from bench.plant.measured_motion import measured_velocity


def closed_loop_gap(recordings: Recordings, extension: Extension) -> tuple[float, float] | None:
    """Velocity gap without and with the effect that is visible only there, in motion that shows it - rad/s (m/s).

    None where there is no such effect, the rig describes no drive, the recording holds no references, or the simulation
    diverges.
    """
    index = under_drive(extension)
    if index is None or "velocity_reference" not in recordings.trace:
        return None
    without, whole = extension.less(index).whole, extension.whole
    if without.model is None or whole.model is None:
        return None
    (shown,) = (present for present in whole.beside if present.effect.shows_under_drive)
    trace = shown.effect.shown_in(recordings.trace, recordings.rig, dict(shown.values))
    velocity = measured_velocity(trace)
    try:
        followed = [
            follow_references(stored.model, trace, recordings.rig).velocity for stored in (without.model, whole.model)
        ]
    except BenchError:
        return None
    before, after = (rms(simulated - velocity) for simulated in followed)
    return before, after


def under_drive(extension: Extension) -> int | None:
    """Index of the effect that is visible only under the drive of the rig; None without one."""
    own = len(extension.hypothesis.terms)
    shown = [own + k for k, present in enumerate(extension.beside) if present.effect.shows_under_drive]
    return shown[0] if shown else None
