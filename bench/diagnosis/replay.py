"""A model run along a recording: held to it softly, both side by side, or let free.

Let free, it begins as the sensors have the axis, driven by the recorded torque, and is held by nothing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from bench.arrays import Array, known_rms, rms
from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.model import holding_bandwidth, tracking
from bench.diagnosis.tabulated import remaining
from bench.errors import InputError, SimulationError, UndeterminedError
from bench.fit.hypothesis import lay_out
from bench.fit.rows import Rows
from bench.fit.stored import EVERY, Balance
from bench.plant.model_file import LARGEST_VALUE, StoredModel, load_model, read_table
from bench.plant.tracking import SoftTracking, Tracked, run_free, track
from bench.rig.given import Given, GivenRig, Units, rig_of, trace_of
from bench.rig.rig import Rig
from bench.structured import csv_text
from bench.trace.motion import measured_position, measured_velocity, stretches_of
from bench.trace.trace import Trace

#: Share of a recording's torque that the model of its axis does not leave unexplained.
LEFT = 0.2
#: Longest that it is let free - s -, and how many windows begin within the length of one.
LONGEST, BEGIN = 5.0, 4
#: After so long it is shown how far off it is, and begins anew where that is shown - s.
HORIZONS = (0.5, 1.0, 2.0, 5.0)
#: How a model is run that a weak cascade keeps near its recording, with and without its effects.
HELD, BARE = "held softly", "held, without what was found"


@dataclass(frozen=True, repr=False)
class Replay:
    """Signals at every sample of a recording, all (n,); nan where the model says nothing.

    Attributes:
        time: s.
        position, position_simulated: rad (m); where none was recorded, each stretch without holes counts from zero.
        velocity, velocity_simulated: rad/s (m/s).
        torque, torque_simulated: both through the filter the model was fitted with - N*m (N).
        speed_unit, effort_unit: of velocity and torque.
        warnings: what the user should know before believing them.
    """

    time: Array
    position: Array
    position_simulated: Array
    velocity: Array
    velocity_simulated: Array
    torque: Array
    torque_simulated: Array
    speed_unit: str
    effort_unit: str
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"Replay({self.summary})"

    @property
    def summary(self) -> str:
        """Both gaps in one line; without the one that the model says nothing about."""
        torque, left = known_rms(self.torque), known_rms(self.torque - self.torque_simulated)
        velocity, apart = known_rms(self.velocity), known_rms(self.velocity - self.velocity_simulated)
        of_torque = f"torque gap {left:.4g} of {torque:.4g} {self.effort_unit}"
        of_velocity = f"velocity gap {apart:.4g} of {velocity:.4g} {self.speed_unit}"
        return f"{of_torque}, {of_velocity}" if np.isfinite(self.velocity_simulated).any() else of_torque

    @property
    def measured(self) -> dict[str, Array]:
        """Of a joint's state: position, velocity, effort."""
        return {"position": self.position, "velocity": self.velocity, "effort": self.torque}

    @property
    def simulated(self) -> dict[str, Array]:
        """The same of the model."""
        return {
            "position": self.position_simulated,
            "velocity": self.velocity_simulated,
            "effort": self.torque_simulated,
        }

    def csv(self) -> str:
        """The contract's CSV, empty cells where the model says nothing."""
        speed, effort = self.speed_unit, self.effort_unit
        head = f"time [s],velocity [{speed}],velocity_simulated [{speed}],torque [{effort}],torque_simulated [{effort}]"
        both = self.velocity, self.velocity_simulated, self.torque, self.torque_simulated
        return csv_text(head.split(","), np.column_stack([self.time, *both]).tolist())


def replay(model: Diagnosis | str | Path, trace: Given, rig: GivenRig, units: Units | None = None) -> Replay:
    """Run the model of a diagnosis, or of the `model.toml` that it wrote, along a recording.

    Args:
        model: the diagnosis, or the path of the file or of its folder.
        trace: the recording, or its file, arrays by their names or a data frame.
        rig: of the axis, as `identify` takes it.
        units: of columns by their names, which replace those of the file or data frame.

    Raises:
        InputError: no model, one without the torque balance that `bench diagnose` writes, or of another kind of axis.
        UndeterminedError: the recording is too short for the model's filter, or never moves clearly.
        SimulationError: the model diverged.
    """
    rig = rig_of(rig)
    trace = trace_of(trace, rig, units)
    path, table, balance, stored = parts_of(model, rig)
    peak = stored.model.peak_effort if stored is not None and math.isfinite(stored.model.peak_effort) else None
    try:
        rows = Rows.of(trace, rig, width=balance.width, every=True, peak_effort=peak)
    except UndeterminedError as error:
        raise UndeterminedError(f"the torque gap along {trace.origin}", error.reason, error.record) from error
    owners = lay_out(rows, balance.hypothesis).owners
    if owners.size != balance.theta.size:
        where, found = f"{path}: torque_balance.coefficients", f"found {balance.theta.size} of them"
        raise InputError(where, found, f"allowed: {owners.size}, as its effects want")
    samples = rows.samples()
    torque, simulated = np.full(len(trace), np.nan), np.full(len(trace), np.nan)
    effects = () if stored is None else stored.model.effects
    torque[samples], simulated[samples] = rows.effort, rows.effort - remaining(balance, rows, effects)
    position, velocity = np.full((2, len(trace)), np.nan)
    measured = measured_position(trace), measured_velocity(trace)
    if stored is not None:
        held = tracking(stored, trace, rig, balance.recording in (EVERY, trace.origin))
        tracked = track(held, holding_bandwidth(held.model, float(np.abs(measured[1]).max())))
        position, velocity = tracked.position, tracked.velocity
    warnings = []
    if str(table.get("name", rig.name)) != rig.name:
        warnings.append(f"the model is of '{table['name']}', the rig file of '{rig.name}'")
    left = known_rms(torque - simulated) / max(known_rms(torque), 1e-300)
    if left > LEFT:
        warnings.append(f"the model leaves {left:.0%} of the torque unexplained: another axis, or other units?")
    moved = measured[0], position, measured[1], velocity
    return Replay(
        trace.time, *moved, torque, simulated, rig.axis_kind.speed_unit, rig.own_effort(trace)[1], tuple(warnings)
    )


def parts_of(
    model: Diagnosis | str | Path, rig: Rig
) -> tuple[str | Path, Mapping[str, Any], Balance, StoredModel | None]:
    """Of a model of the rig's kind: where it is from, kind and name, its torque balance, what MuJoCo runs of it."""
    if not isinstance(model, Diagnosis | str | Path):
        allowed = "allowed: the diagnosis itself, replay(found, ...), or the folder that found.save(folder) wrote"
        raise InputError("model", f"found {type(model).__name__}, which has no torque balance", allowed)
    if isinstance(model, Diagnosis):
        path, one = "diagnosis", model.model
        table = {} if one is None else {"kind": one.model.parameters.kind.name, "name": one.name}
    else:
        path, table = model, read_table(model)
    kind = table.get("kind", rig.kind)
    if kind != rig.kind:  # before parameters are read, as those of that kind
        raise InputError(f"{path}: kind", f"found {kind!r}", f"allowed: '{rig.kind}', as {rig.source} says")
    if isinstance(model, Diagnosis):
        return path, table, model.balance, model.model
    return path, table, load_balance(model), load_model(model) if "parameters" in table else None


def load_balance(path: str | Path) -> Balance:
    """The torque balance in a `model.toml`.

    Raises:
        InputError: no such file, no TOML, or no torque balance in it.
    """
    table = read_table(path)
    if "torque_balance" not in table:
        raise InputError(f"{path}: torque_balance", "missing", "allowed: a model.toml that bench diagnose wrote")
    where = f"{path}: torque_balance"
    if not isinstance(table["torque_balance"], dict):
        raise InputError(where, f"found {table['torque_balance']!r}", "allowed: a table, as bench diagnose wrote it")
    try:
        balance = Balance.from_table(table["torque_balance"], where)
    except KeyError as error:
        raise InputError(f"{where}.{error.args[0]}", "missing", "allowed: as bench diagnose wrote it") from error
    except (TypeError, ValueError) as error:
        raise InputError(where, f"found {error}", "allowed: as bench diagnose wrote it") from error
    _require_sound(balance, where)
    return balance


def _require_sound(balance: Balance, where: str) -> None:
    if not 0.0 < balance.width < math.inf:
        raise InputError(f"{where}.filter_width", f"found {balance.width:g}", "allowed: a width above zero - s")
    if not (np.abs(balance.theta) <= LARGEST_VALUE).all():  # nor nan
        allowed = f"allowed: finite numbers up to {LARGEST_VALUE:g}"
        raise InputError(f"{where}.coefficients", "found one that no servo axis has", allowed)
    for term in balance.hypothesis.terms:
        size = len(term.effect.shapes)
        if len(term.shape) != size or not np.isfinite(term.shape).all():
            found = f"found {list(term.shape)}"
            raise InputError(f"{where}.effects: {term.effect.name}.shape", found, f"allowed: {size} finite numbers")


@dataclass(frozen=True)
class FreeRun:
    """How far off a model runs, over the time since it was let free.

    Attributes:
        time: since then - s (n,).
        position, velocity: RMS over windows of simulated less measured - rad (m), rad/s (m/s) - (n,).
        windows: how many.
    """

    time: Array
    position: Array
    velocity: Array
    windows: int


def let_free(model: Diagnosis | str | Path, trace: Trace, rig: Rig) -> FreeRun | None:
    """Run a model from many moments of a recording by itself; None where it holds no motion.

    Windows of 5 s, or of half of the longest stretch without holes, begin every quarter of one. Noise of the sensors at
    the moment at which a window begins stays in its motion.

    Raises:
        InputError: as `bench.replay`.
        SimulationError: the model diverged.
    """
    held = _held(model, trace, rig)
    if held is None:
        return None
    stretches = stretches_of(trace)
    length = min(round(LONGEST / trace.sample_period) + 1, max(part.stop - part.start for part in stretches) // 2)
    every = max(length // BEGIN, 1)
    windows = [slice(k, k + length) for part in stretches for k in range(part.start, part.stop - length + 1, every)]
    position, velocity, runs = measured_position(trace), measured_velocity(trace), _free(held, windows)
    off = [one.position - position[part] for one, part in zip(runs, windows, strict=True)]
    late = [one.velocity - velocity[part] for one, part in zip(runs, windows, strict=True)]
    time = trace.sample_period * np.arange(length, dtype=np.float64)
    position_off, velocity_off = (np.array([rms(column) for column in np.transpose(each)]) for each in (off, late))
    return FreeRun(time, position_off, velocity_off, len(windows))


def otherwise(
    model: Diagnosis | str | Path, trace: Trace, rig: Rig, horizons: Sequence[float] = HORIZONS
) -> dict[str, Array]:
    """Positions of a model that is let free anew every so often, by how often - rad (m) - (n,).

    None of them where the model holds no motion, the recording is shorter, or the model diverged.

    Raises:
        InputError: as `bench.replay`.
    """
    held, found = _held(model, trace, rig), dict[str, Array]()
    if held is None:
        return found
    for horizon in horizons:
        windows, position = windows_of(trace, horizon), np.full(len(trace), np.nan)
        if not any(part.stop - part.start == round(horizon / trace.sample_period) for part in windows):
            continue
        with suppress(SimulationError):
            for part, one in zip(windows, _free(held, windows), strict=True):
                position[part] = one.position
            found[f"let free every {horizon:g} s"] = position
    return found


def windows_of(trace: Trace, horizon: float) -> list[slice]:
    """Windows of so long - s -, one after the other, the last one of each stretch without holes as long as that is."""
    length = max(round(horizon / trace.sample_period), 2)
    return [
        slice(start, min(start + length, part.stop))
        for part in stretches_of(trace)
        for start in range(part.start, part.stop - 1, length)
    ]


def bare(model: Diagnosis | str | Path, trace: Trace, rig: Rig) -> Array | None:
    """Position of a model without its effects, held softly - rad (m) - (n,); None where it has none, or diverged.

    Raises:
        InputError: as `bench.replay`.
    """
    held = _held(model, trace, rig)
    if held is None or not held.model.effects:
        return None
    without, top = held.model.with_effects([]), float(np.nanmax(np.abs(measured_velocity(trace))))
    with suppress(SimulationError):
        return track(replace(held, model=without), holding_bandwidth(without, top)).position
    return None


def _held(model: Diagnosis | str | Path, trace: Trace, rig: Rig) -> SoftTracking | None:
    """A model and what drives it along a recording; None where it holds no motion."""
    _, _, balance, stored = parts_of(model, rig)
    return None if stored is None else tracking(stored, trace, rig, balance.recording in (EVERY, trace.origin))


def _free(held: SoftTracking, windows: Sequence[slice]) -> list[Tracked]:
    """Its motion in windows, in the recording's position."""
    runs, position = run_free(held, windows), measured_position(held.trace)
    if "position" in held.trace:
        return runs
    begun = (position[part.start] for part in windows)  # a run counts from zero, as an integral does
    return [replace(one, position=one.position + at) for one, at in zip(runs, begun, strict=True)]
