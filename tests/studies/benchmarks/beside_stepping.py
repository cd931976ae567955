"""Beside MuJoCo's own stepping: what a simulated step costs with drive, records and effects around it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import mujoco
import numpy as np
from mujoco import rollout

from bench.plant.drive import References, add_pid
from bench.plant.plant import Plant
from bench.plant.run import run, run_native, run_ticked
from tests.effects.axes import Reversals, plant
from tests.studies.benchmarks.table import Table
from tests.studies.benchmarks.timing import Way, in_turn

#: Effects of each kind, as many: what MuJoCo makes by itself, and what has to act in every step.
NATIVE = ("cogging_torque", "elastic_coupling", "presliding_friction", "quadratic_drag", "torsion_spring")
TICKED = (
    "direction_dependent_friction",
    "friction_warmup",
    "position_dependent_inertia",
    "stribeck_friction",
    "torque_ripple",
)
BARE = "bare `mj_step` in a loop"


def stepped(model: mujoco.MjModel, steps: int) -> None:
    """Nothing but steps."""
    data = mujoco.MjData(model)
    for _ in range(steps):
        mujoco.mj_step(model, data)


def rolled(model: mujoco.MjModel, steps: int) -> None:
    """One rollout."""
    start = np.zeros((1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    rollout.rollout([model], [mujoco.MjData(model)], start, np.zeros((1, steps, model.nu)))


def by_ticks(one: Plant, motion: References) -> None:
    """An axis along a motion, its model compiled anew."""
    run_ticked(replace(one).ticked_loop(motion))


def with_pid(one: Plant) -> mujoco.MjModel:
    """The axis with its drive as MuJoCo's own actuator."""
    spec = one.spec()
    add_pid(spec, one.cascade)
    return spec.compile()


def measured(steps: int = 4000, rounds: int = 7) -> list[Table]:
    """One axis over `steps` steps."""
    bare, ticked, native = plant(), plant(*TICKED), plant(*NATIVE)
    motion = Reversals(bare.cascade.control_period * (steps - 0.5)).references()
    assert motion.time.size == steps
    ways: dict[str, Way] = {
        BARE: partial(stepped, with_pid(bare), steps),
        "`mujoco.rollout`": partial(rolled, with_pid(bare), steps),
        "drive in MuJoCo": lambda: run_native(replace(bare).native_loop(motion)),
        "the same with five native effects": lambda: run_native(replace(native).native_loop(motion)),
        "by ticks": partial(by_ticks, bare, motion),
        "the same with friction by the drive": partial(by_ticks, replace(bare, emulated=True), motion),
        "the same with five ticked effects": partial(run, ticked, motion),
    }
    timed = in_turn(ways, rounds)
    rows = [(name, f"{1e6 * timed.median(name) / steps:.3g} us", f"{timed.ratio(name, BARE):.2f}") for name in ways]
    says = (
        f"Time of a step of one axis over {steps} steps, building models included. By ticks means that the drive's law "
        "is Python, which has to be where a torque is limited or an effect acts that MuJoCo does not have."
    )
    return [Table(says, ("", "step", "times bare `mj_step`"), tuple(rows))]
