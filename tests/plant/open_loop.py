"""An axis under given efforts, without a controller."""

import mujoco
import numpy as np

from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.drive import sense_torque
from bench.plant.plant import ClosedLoop, States
from bench.plant.run import run_native


def open_loop(spec: mujoco.MjSpec, efforts: np.ndarray, position: float = 0.0, velocity: float = 0.0) -> States:
    """Motion of a model - rad, rad/s (m, m/s) - whose drive makes efforts, each held for a step - N*m (N) - (n,)."""
    sense_torque(spec)
    model = spec.compile()
    time = np.arange(efforts.size) * model.opt.timestep
    nothing = AxisModel(AxisParameters(1.0))
    inputs = np.column_stack([efforts, np.zeros_like(efforts)])
    return run_native(ClosedLoop(nothing, model, lambda start, stop: inputs[start:stop], time, position, velocity))
