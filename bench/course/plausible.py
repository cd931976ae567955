"""Whether a recording can be of the lab's axis: it is compared with motor, disk, and the other recordings.

    M(t + late) = J*alpha + K_w*omega + K_0*sgn(omega)

with every column through one filter, so that nothing is late by filtering. On 27 recordings of the class's axes J
came out within 0.02 %, `late` within 0.055 samples, and 0.2 to 0.4 % of the torque were unexplained; limits have room
for a real axis.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.course.axis import MAINS
from bench.course.methods import KG_CM2, RPM
from bench.course.run import LabRun
from bench.names import percent
from bench.rig.limits import peak_curve
from bench.rig.rig import Rig
from bench.trace.filter import GaussianFilter

WITHOUT_FRICTION, WITH_FRICTION, FASTEST = "JLoadWithoutFriction", "JLoadAndFriction", "MaxAcc"
#: What J_load is held against.
DISK = "what the disk has in theory"
#: Width of the filter - samples; slower samples than this share of the fastest are left out: friction is no constant.
WIDTH, SLOW = 2.0, 0.13
#: Shares of no-load speed and of peak current that are passed by a wrong unit only, and that MaxAcc reaches.
FASTEST_SPEED, LARGEST_CURRENT, FULL_CURRENT = 1.05, 1.03, 0.95
#: J_load over the disk's theory: hub, coupling and bolts are 10 to 20 % more.
OVER_THEORY = (0.85, 1.35)
#: Samples that torque may come after acceleration; share of the torque that may be unexplained; of it that friction
#: has.
LATE, LEFT, FRICTION = 0.4, 0.05, 0.015
#: J of one recording against the others', that of two of one motion, whose currents are alike, so that kT cannot part
#: them; and the share of a recording that holes may cut off where they cut no run-up.
BETWEEN, OF_ONE_MOTION, CUT = 0.05, 0.01, 0.2
#: Steps of a signal as a share of its largest: a current that is rounded to more moves J by more than its interval, and
#: one of finer steps is not the same for so many samples unless it was cut off or held, or the drive is at its limit.
COARSE, FINE, HELD, AT_LIMIT = 0.005, 1e-4, 8, 0.99
#: An isolated sample is off by so many times the noise, and by more than twice the usual step between samples.
GLITCH, STEP = 10.0, 2.0


@dataclass(frozen=True)
class TorqueBalance:
    """Properties of a recording by itself.

    Attributes:
        inertia: J - kg*m**2.
        viscous: K_w - N*m*s/rad.
        coulomb: K_0 - N*m.
        late: torque after acceleration - samples.
        left: what none of it explains, as a share of the torque's RMS.
        torque: RMS - N*m.
    """

    inertia: float
    viscous: float
    coulomb: float
    late: float
    left: float
    torque: float


def balance(run: LabRun) -> TorqueBalance | None:
    """Least squares of the torque's balance; None where the axis hardly moves, or too short."""
    smooth = GaussianFilter(WIDTH * run.sample_period, run.sample_period)
    if run.time.size <= 2 * smooth.margin:
        return None
    velocity, alpha, jerk = smooth(run.velocity, 0, 1, 2)
    torque = smooth(run.torque, 0)[0]
    fast = np.abs(velocity) > SLOW * np.abs(velocity).max(initial=0.0)
    columns = np.stack([alpha, velocity, np.sign(velocity), jerk], axis=1)[fast]
    theta, _, _, _ = np.linalg.lstsq(columns, torque[fast], rcond=None)
    if theta[0] == 0.0 or not fast.any():
        return None
    size = rms(torque[fast])
    left = rms(torque[fast] - columns @ theta) / size if size else 0.0
    inertia, viscous, coulomb, moved = theta.tolist()
    return TorqueBalance(inertia, viscous, coulomb, -moved / inertia / run.sample_period, left, size)


def inertia_of(run: LabRun) -> float | None:
    """J of that balance - kg*m**2."""
    found = balance(run)
    return None if found is None else found.inertia


def glitches(values: Array, smooth: bool) -> NDArray[np.int64]:
    """Samples of (n,) that stand alone; those of a smooth signal are held against a cubic through their neighbours."""
    x = np.pad(values, 2, mode="edge")
    around = np.stack([x[:-4], x[1:-3], x[3:-1], x[4:]])
    expected = np.array([-1.0, 4.0, 4.0, -1.0]) / 6.0 @ around if smooth else np.median([*around, values], axis=0)
    off = np.abs(values - expected)
    off[[0, 1, -2, -1]] = 0.0
    found = np.flatnonzero(off > GLITCH * 1.4826 * float(np.median(off)))
    if found.size:
        found = found[off[found] > np.quantile(np.abs(np.diff(values)), 0.98) * (1.0 if smooth else STEP)]
    # the cubic of its neighbours is off, too, by less
    return found[[off[k] == off[max(k - 2, 0) : k + 3].max() for k in found]] if found.size else found


def holes(name: str, run: LabRun) -> str:
    """What holes cut off, where that is too much; empty where it is not."""
    share, since = run.missing
    found = f"it has a hole after {since:.4g} s, and {percent(share)} of it are cut off by holes"
    return found if share > (0.0 if name == FASTEST else CUT) else ""


def fault(name: str, run: LabRun, rig: Rig) -> str:
    """What cannot be so in one recording, in words; empty where nothing is."""
    found = chain([holes(name, run)], _of_signals(run, rig), _of_balance(name, run, rig))
    return next(filter(None, found), "")


def _of_signals(run: LabRun, rig: Rig) -> Iterator[str]:
    """What is beyond the motor, or no reading of a sensor."""
    limit, peak = peak_curve(rig.motor, MAINS, rig.source) if rig.motor.peak_curves else None, rig.motor.peak_current
    signals = (("speed", "rad/s", run.velocity), ("current", "A", run.current))
    speed, current = (float(np.abs(values).max()) for _, _, values in signals)
    if limit is not None and speed > FASTEST_SPEED * limit.no_load_speed:
        top = limit.no_load_speed * RPM
        yield f"its highest speed is {speed * RPM:,.0f} rpm, and the motor has {top:,.0f} rpm at {MAINS:g} V at most"
    if peak is not None and current > LARGEST_CURRENT * peak:
        yield f"its largest current is {current:.4g} A, and the drive gives {peak:.4g} A at most"
    step = 0.0
    for signal, unit, values in signals:
        largest = float(np.abs(values).max()) or 1.0
        levels = np.unique(np.round(values / largest, 9))
        step = float(np.diff(levels).min()) if levels.size > 1 else 0.0
        if step > COARSE:
            found = f"{step * largest:.2g} {unit}, {percent(step)} of the largest"
            yield f"its {signal} comes in steps of {found}: too coarse"
    changes = np.flatnonzero(np.diff(run.current, prepend=np.nan, append=np.nan))
    lengths, values = np.diff(changes), np.abs(run.current[changes[:-1]])
    held = (lengths > HELD) & (values > 0.0) & (values < AT_LIMIT * (peak or math.inf))
    if step < FINE and held.any():  # the current's step
        start, length = int(changes[:-1][held][0]), int(lengths[held][0])
        where = f"{length} samples after {run.time[start]:.4g} s"
        yield f"its current is {run.current[start]:.4g} A to the last digit for {where}: it was cut off, or held"
    for signal, unit, values in signals:
        alone = glitches(values, signal == "speed")
        if alone.size:
            k = int(alone[0])
            which = f"one of {alone.size} samples" if alone.size > 1 else "a sample"
            where = f"{values[k]:.4g} {unit} at {run.time[k]:.4g} s"
            yield f"{which} of the {signal}, {where}, is isolated, far from its neighbours"


def _of_balance(name: str, run: LabRun, rig: Rig) -> Iterator[str]:
    """What the torque's balance contradicts, and what is no run-up with full torque past the corner."""
    found = balance(run)
    if found is None:
        return
    theory = rig.load.disk_inertia if rig.load else None
    inertia = found.inertia * KG_CM2
    if inertia < 0.0:
        yield f"its J comes out as {inertia:.3g} kg*cm**2, as torque and acceleration have opposite signs"
    if theory is not None and rig.motor.rotor_inertia is not None:
        ratio = (found.inertia - rig.motor.rotor_inertia) / theory
        if not OVER_THEORY[0] < ratio < OVER_THEORY[1]:
            yield (
                f"its J comes out as {inertia:.4g} kg*cm**2 and J_load as {ratio:.3g} times {DISK}, "
                f"allowed: {OVER_THEORY[0]:g} to {OVER_THEORY[1]:g} times, as hub and bolts turn, too"
            )
    if abs(found.late) > LATE:
        yield f"its torque comes {found.late:+.1f} samples after the acceleration that it makes"
    if found.left > LEFT:
        share = percent(found.left)
        yield f"inertia and friction do not explain {share} of its torque; noise alone is below {percent(LEFT)}"
    friction = found.coulomb / found.torque
    if name == WITHOUT_FRICTION and friction > FRICTION:
        yield f"it shows friction, {found.coulomb:.3g} N*m, which was to be switched off"
    if name == WITH_FRICTION and friction < FRICTION:
        yield f"it shows no friction ({found.coulomb:.2g} N*m), which was to be switched on"
    top, peak = float(run.current.max()), rig.motor.peak_current
    if name == FASTEST and peak is not None and top < FULL_CURRENT * peak:
        yield f"its largest current is {top:.4g} A, and the run-up with full torque takes {peak:.4g} A"
    if name == FASTEST and rig.motor.peak_curves:
        corner, reached = peak_curve(rig.motor, MAINS, rig.source).corner_speed, float(run.velocity.max())
        if reached < corner:
            sheet = f"the corner of the datasheet, {corner * RPM:.0f} rpm"
            yield f"its highest speed is {reached * RPM:.0f} rpm, below {sheet}"


def between(inertias: Mapping[str, float | None]) -> dict[str, str]:
    """Of recordings that are sound by themselves, those whose J - kg*m**2 - contradicts the others', with what does."""
    found = {name: inertia for name, inertia in inertias.items() if inertia is not None}
    if len(found) < 2:
        return {}
    middle, limits = float(np.median([*found.values()])), dict.fromkeys(found, OF_ONE_MOTION) | {FASTEST: BETWEEN}
    if len(found) == 2:
        limits = dict.fromkeys(found, max(limits[name] for name in found) / 2.0)
    apart = {name: abs(value / middle - 1.0) > limits[name] for name, value in found.items()}
    values = ", ".join(f"{value * KG_CM2:.4g} by {name}" for name, value in found.items())
    return {name: f"J in kg*cm**2 is {values}: one axis has one J" for name, is_apart in apart.items() if is_apart}
