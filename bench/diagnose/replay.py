"""Replay: a model run along a recording, measured and simulated signals side by side."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.balance import Balance
from bench.diagnose.workbench import Workbench
from bench.errors import InputError
from bench.plant.model_file import load_model
from bench.plant.track import measured_velocity
from bench.plant.track_effects import track_effects
from bench.rig.rig import Rig
from bench.trace.trace import Trace

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Replay:
    """Signals at every sample of a recording, all (n,); nan where the model says nothing.

    Attributes:
        time: s.
        velocity, velocity_simulated: rad/s (m/s).
        torque, torque_simulated: both through the filter the model was fitted with - N*m (N).
        linear: whether the axis is linear.
    """

    time: Array
    velocity: Array
    velocity_simulated: Array
    torque: Array
    torque_simulated: Array
    linear: bool

    def csv(self) -> str:
        """The contract's CSV, empty cells where the model says nothing."""
        speed, effort = ("m/s", "N") if self.linear else ("rad/s", "N*m")
        head = f"time [s],velocity [{speed}],velocity_simulated [{speed}],torque [{effort}],torque_simulated [{effort}]"
        table = np.column_stack([self.time, self.velocity, self.velocity_simulated, self.torque, self.torque_simulated])
        rows = [",".join("" if value != value else f"{value:.9g}" for value in row) for row in table.tolist()]
        return "\n".join([head, *rows]) + "\n"


def replay(path: Path, trace: Trace, rig: Rig) -> Replay:
    """Run the model of a `model.toml` along a recording.

    Raises:
        InputError: no model, or one without the torque balance that `bench diagnose` writes.
        SimulationError: the model diverged.
    """
    balance = load_balance(path)
    bench = Workbench.of(trace, rig, balance.width, every=True)
    samples = bench.samples(trace)
    torque, simulated = np.full(len(trace), np.nan), np.full(len(trace), np.nan)
    torque[samples], simulated[samples] = bench.effort, balance.torque(bench)
    velocity = np.full(len(trace), np.nan)
    if _has_model(path):
        stored = load_model(path)
        effort, _ = rig.net_effort(trace)
        velocity = track_effects(stored.model, trace, effort, stored.misalignment)
    return Replay(trace.time, measured_velocity(trace), velocity, torque, simulated, rig.linear)


def load_balance(path: Path) -> Balance:
    """The torque balance in a `model.toml`.

    Raises:
        InputError: no such file, no TOML, or no torque balance in it.
    """
    table = _table(path)
    if "torque_balance" not in table:
        raise InputError(f"{path}: torque_balance", "missing", "allowed: a model.toml that bench diagnose wrote")
    try:
        return Balance.from_table(table["torque_balance"])
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: torque_balance", f"found {error}", "allowed: as bench diagnose wrote it") from error


def _has_model(path: Path) -> bool:
    return "parameters" in _table(path)


def _table(path: Path) -> dict:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})", "name the model.toml of a diagnosis") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(path, f"not TOML ({error})", "allowed: a model.toml that bench diagnose wrote") from error
