"""Velocity gap under the drive of the rig, from the references of a recording: prediction, nothing holds the model.

Feedback hides most effects here - the drive makes good what the model lacks - but for what happens in the drive itself
it is the only place to look: a voltage limit acts before the recorded current, with which the held model is fed.
"""

from __future__ import annotations

import numpy as np

from bench.diagnose.chain import Grown
from bench.diagnose.recordings import Recordings
from bench.diagnose.voltage import VOLTAGE_LIMIT
from bench.errors import BenchError
from bench.plant.follow import follow_references
from bench.plant.track import measured_velocity
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Share of the top speed below which an axis rests.
RESTING = 0.02
#: Share of the voltage's limit above which it stands at it, and samples in a row that it must.
TOP, STEADY = 0.97, 5
#: Length of the motion - s: the drive is ticked; and of what must follow once the limit is reached.
LONGEST, SHORTEST = 3.0, 0.5


def closed_loop_gap(recordings: Recordings, without: Grown, whole: Grown) -> tuple[float, float] | None:
    """Velocity gap of two models around where the axis first falls behind - rad/s (m/s).

    None where the rig describes no drive, the recording holds no references, or the simulation diverges.
    """
    if without.model is None or whole.model is None or "velocity_reference" not in recordings.trace:
        return None
    (voltage,) = (dict(p.values)["voltage"] for p in whole.beside if p.name == VOLTAGE_LIMIT)
    trace = at_the_limit(recordings.trace, recordings.rig, voltage)
    velocity = measured_velocity(trace)
    try:
        followed = [
            follow_references(grown.model.model, trace, recordings.rig).velocity
            for grown in (without, whole)
            if grown.model is not None
        ]
    except BenchError:
        return None
    before, after = (float(np.sqrt(np.mean((simulated - velocity) ** 2))) for simulated in followed)
    return before, after


def at_the_limit(trace: Trace, rig: Rig, voltage: float) -> Trace:
    """The recording from the last rest before the motor first needs all of a voltage - V -, for at most LONGEST."""
    motor = rig.motor
    needed = np.abs((motor.resistance or 0.0) * trace["current"] + (motor.back_emf_constant or 0.0) * trace["velocity"])
    steadily = np.convolve(needed > TOP * voltage, np.ones(STEADY), "valid") >= STEADY
    first = int(np.argmax(steadily))
    reference = trace["velocity_reference"]
    resting = np.abs(reference) + np.abs(trace["velocity"]) < RESTING * np.abs(reference).max()
    rests = np.flatnonzero(resting[: first + 1])
    start = float(trace.time[rests[-1] if rests.size else 0])
    return trace.between(start, max(start + LONGEST, float(trace.time[first]) + SHORTEST))
