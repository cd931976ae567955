"""Speed of the simulation against bare `mj_step` on the same model, within one run. Printed, never asserted.

pytest -m slow tests/plant/test_speed.py -s
"""

import dataclasses
import time

import mujoco
import numpy as np
import pytest

from bench.plant.drive import add_pid
from bench.plant.native import run_native
from bench.plant.ticks import run_ticks
from tests.plant.test_drive import reversals

STEPS = 8000

pytestmark = pytest.mark.slow


def bare(plant):
    """Nothing but steps of the axis with its drive as MuJoCo's actuator."""
    spec = plant.spec()
    add_pid(spec, plant.cascade)
    model = spec.compile()
    data = mujoco.MjData(model)
    for _ in range(STEPS):
        mujoco.mj_step(model, data)
    return data


def timed(function):
    start = time.perf_counter()
    return function(), time.perf_counter() - start


def test_ratios_to_a_bare_step(plant):
    motion, short = reversals(duration=STEPS * 250e-6), reversals(duration=200 * 250e-6)
    emulated = dataclasses.replace(plant, emulated=True)
    ways = {
        "bare mj_step": (lambda: bare(plant), STEPS),
        "one axis in one rollout": (lambda: run_native(plant, motion), STEPS),
        "one axis by ticks": (lambda: run_ticks([plant], [motion]), STEPS),
        "one axis by ticks, friction by the drive": (lambda: run_ticks([emulated], [motion]), STEPS),
        "1000 axes by ticks": (lambda: run_ticks([plant] * 1000, [short] * 1000), 200 * 1000),
    }
    times, made = {name: [] for name in ways}, {}
    for _ in range(3):  # in turn, so that all share what else the machine is doing
        for name, (function, axis_steps) in ways.items():
            made[name], seconds = timed(function)
            times[name].append(seconds / axis_steps)
    unit = min(times["bare mj_step"])
    print()
    for name, measured in times.items():
        print(f"{name:42s} {min(measured) * 1e6:6.2f} us per axis and step, {min(measured) / unit:5.2f} times bare")
    whole, many = made["one axis by ticks"].velocity, made["1000 axes by ticks"].velocity
    assert made["bare mj_step"].time == pytest.approx(STEPS * 250e-6)
    assert whole.shape == made["one axis in one rollout"].velocity.shape == (STEPS, 1)
    np.testing.assert_array_equal(many[:, -1], many[:, 0])


@pytest.mark.parametrize("way", ["bare mj_step", "one rollout", "ticks"])
def test_benchmark(benchmark, plant, way):
    motion = reversals(duration=STEPS * 250e-6)
    run = {
        "bare mj_step": lambda: bare(plant),
        "one rollout": lambda: run_native(plant, motion),
        "ticks": lambda: run_ticks([plant], [motion]),
    }
    benchmark.pedantic(run[way], rounds=5, warmup_rounds=1)
