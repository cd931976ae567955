"""Voltage limit: speed falls behind its reference while the voltage the motor needs stands at its top."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.diagnose.workbench import Workbench
from bench.rig.rig import Rig
from bench.trace.filter import GaussianFilter
from bench.trace.trace import Trace

VOLTAGE_LIMIT = "voltage_limit"

#: Speed behind its reference that counts as falling behind, as share of the largest reference.
BEHIND = 0.02
#: Share of the top within which the voltage counts as standing at it, share of the samples behind that do, and samples.
TOP, STANDING, SAMPLES = 0.015, 0.5, 20


@dataclass(frozen=True)
class VoltageLimit:
    """Found limit.

    Attributes:
        voltage: the top - V.
        std_error: V.
        samples: at the top while behind.
        behind: largest speed behind the reference there - rad/s (m/s).
    """

    voltage: float
    std_error: float
    samples: int
    behind: float


def voltage_limit(trace: Trace, rig: Rig, bench: Workbench) -> VoltageLimit | None:
    """The limit, None where none was reached or the rig lacks winding or the recording the reference.

    u = R*i + Ke*omega + L*di/dt.
    """
    motor = rig.motor
    known = motor.resistance is not None and motor.back_emf_constant is not None
    if not known or not {"current", "velocity_reference", "velocity"} <= set(trace.signals):
        return None
    smooth = GaussianFilter(max(bench.conditioning.filter.width, 1.5 * trace.sample_period), trace.sample_period)
    voltages, lacks = [], []
    for part in trace.segments:
        if part.stop - part.start <= 4 * smooth.margin:
            continue
        current, slope = smooth(trace["current"][part], 0, 1)
        (speed,) = smooth(trace["velocity"][part], 0)
        (wanted,) = smooth(trace["velocity_reference"][part], 0)
        voltages.append(
            motor.resistance * current + motor.back_emf_constant * speed + (motor.inductance or 0.0) * slope
        )
        lacks.append(np.sign(wanted) * (wanted - speed))
    voltage, lack = np.abs(np.concatenate(voltages)), np.concatenate(lacks)
    largest = float(np.abs(trace["velocity_reference"]).max())
    behind = lack > BEHIND * largest
    if np.count_nonzero(behind) < SAMPLES:
        return None
    top = float(np.median(np.sort(voltage)[-max(SAMPLES, np.count_nonzero(behind) // 4) :]))
    standing = behind & (np.abs(voltage / top - 1.0) < TOP)
    count = int(np.count_nonzero(standing))
    if count < SAMPLES or count < STANDING * np.count_nonzero(behind):
        return None
    level = voltage[standing]
    spread = float(level.std() / np.sqrt(max(1.0, count * smooth.sample_period / (4.0 * smooth.width))))
    return VoltageLimit(float(np.median(level)), spread, count, float(lack[standing].max()))
