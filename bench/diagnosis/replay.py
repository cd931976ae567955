"""A model run along a recording that it tracks with low gains, both side by side."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.arrays import Array, known_rms
from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.model import holding_bandwidth, tracking
from bench.diagnosis.tabulated import remaining
from bench.errors import InputError, UndeterminedError
from bench.fit.hypothesis import lay_out
from bench.fit.rows import Rows
from bench.fit.stored import EVERY, Balance
from bench.names import meant, percent, with_known_arguments
from bench.plant.model_file import StoredModel, load_model, read_table
from bench.plant.tracking import track
from bench.presented import ByKey, Shown
from bench.rig.given import Given, GivenRig, Units, rig_of, trace_of
from bench.rig.rig import Rig
from bench.structured import csv_text
from bench.trace.motion import measured_position, measured_velocity

#: Share of a recording's torque that the model of its axis does not leave unexplained.
LEFT = 0.2


@dataclass(frozen=True, repr=False)
class Replay(Shown):
    """Signals at every sample of a recording, all (n,); nan where the model predicts nothing.

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

    def __getitem__(self, name: str) -> Array:
        return meant(name, vars(self))

    @property
    def summary(self) -> str:
        """Both gaps in one line; without the one that the model does not predict."""
        measured, units = (self.torque, self.velocity), (self.effort_unit, self.speed_unit)
        return ", ".join(
            f"{name} gap {gap:.4g} of {known_rms(signal):.4g} {unit}"
            for (name, gap), signal, unit in zip(self.rmse.items(), measured, units, strict=True)
            if name == "torque" or math.isfinite(gap)
        )

    @property
    def rmse(self) -> dict[str, float]:
        """RMS of the residuals of torque and velocity - effort_unit, speed_unit; nan where none is simulated."""
        residuals = {"torque": self.torque_residuals, "velocity": self.velocity_residuals}
        return ByKey({name: known_rms(one) if np.isfinite(one).any() else math.nan for name, one in residuals.items()})

    @property
    def velocity_residuals(self) -> Array:
        """Measured less simulated velocity (n,) - rad/s (m/s)."""
        return self.velocity - self.velocity_simulated

    @property
    def torque_residuals(self) -> Array:
        """The same of the torque (n,) - N*m (N)."""
        return self.torque - self.torque_simulated

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
        """The contract's CSV, empty cells where the model predicts nothing."""
        speed, effort = self.speed_unit, self.effort_unit
        head = f"time [s],velocity [{speed}],velocity_simulated [{speed}],torque [{effort}],torque_simulated [{effort}]"
        both = self.velocity, self.velocity_simulated, self.torque, self.torque_simulated
        return csv_text(head.split(","), np.column_stack([self.time, *both]).tolist())


@with_known_arguments
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
    wanted, unit = (stored and stored.effort_unit) or rig.effort_unit, rig.own_effort(trace)[1]
    if unit != wanted:
        allowed = f"allowed: {wanted}, as in {path}; give the rig of its diagnosis, `--rig RIG`"
        raise InputError(rig.source, f"gives the effort in {unit}", allowed)
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
        warnings.append(f"the model does not explain {percent(left)} of the torque: another axis, or other units?")
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
        raise InputError(f"{path}: kind", f"found {kind!r}", f"allowed: '{rig.kind}', as in {rig.source}")
    if isinstance(model, Diagnosis):
        return path, table, model.balance, model.model
    return path, table, Balance.from_table(table, path), load_model(model) if "parameters" in table else None
