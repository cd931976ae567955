"""Beside MuJoCo's own stepping: what a simulated step costs with drive, records and effects around it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import mujoco
import numpy as np
from mujoco import rollout

from bench.plant.drive import References, add_pid
from bench.plant.plant import Plant
from bench.plant.run import batch_of, run, run_native, run_ticked
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
BARE, BATCH = "bare `mj_step` in a loop", "bare `Batch.step`, {} axes"


def stepped(model: mujoco.MjModel, steps: int) -> None:
    """Nothing but steps."""
    data = mujoco.MjData(model)
    for _ in range(steps):
        mujoco.mj_step(model, data)


def rolled(model: mujoco.MjModel, steps: int) -> None:
    """One rollout."""
    start = np.zeros((1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    rollout.rollout([model], [mujoco.MjData(model)], start, np.zeros((1, steps, model.nu)))


def batched(plants: list[Plant], steps: int) -> None:
    """A batch without drives."""
    batch = batch_of([one.spec().compile() for one in plants[:1]] * len(plants))
    for _ in range(steps):
        batch.step()


def by_ticks(one: Plant, motions: list[References]) -> None:
    """An axis along motions side by side, its model compiled anew."""
    alike = replace(one)
    run_ticked([alike.ticked_loop(motion) for motion in motions])


def with_pid(one: Plant) -> mujoco.MjModel:
    """The axis with its drive as MuJoCo's own actuator."""
    spec = one.spec()
    add_pid(spec, one.cascade)
    return spec.compile()


def measured(steps: int = 4000, axes: int = 1000, few: int = 200, rounds: int = 7) -> list[Table]:
    """One axis over `steps` steps, and `axes` of them over `few`."""
    bare, ticked, native = plant(), plant(*TICKED), plant(*NATIVE)
    period = bare.cascade.control_period
    motion, short = (Reversals(period * (count - 0.5)).references() for count in (steps, few))
    assert (motion.time.size, short.time.size) == (steps, few)
    one, many = [motion], [short] * axes
    ways: dict[str, tuple[Way, int]] = {
        BARE: (partial(stepped, with_pid(bare), steps), steps),
        "`mujoco.rollout`": (partial(rolled, with_pid(bare), steps), steps),
        "one axis, drive in MuJoCo": (lambda: run_native(replace(bare).native_loop(motion)), steps),
        "the same with five native effects": (lambda: run_native(replace(native).native_loop(motion)), steps),
        "one axis by ticks": (partial(by_ticks, bare, one), steps),
        "the same with friction by the drive": (partial(by_ticks, replace(bare, emulated=True), one), steps),
        "the same with five ticked effects": (partial(run, [ticked], one), steps),
        BATCH.format(axes): (partial(batched, [bare] * axes, few), few * axes),
        f"{axes} axes by ticks": (partial(by_ticks, bare, many), few * axes),
        f"{axes} axes, five ticked effects": (partial(run, [ticked] * axes, many), few * axes),
    }
    timed = in_turn({name: way for name, (way, _) in ways.items()}, rounds)
    rows = []
    for name, (_, count) in ways.items():
        times = (timed.ratio(name, other) * ways[other][1] / count for other in (BARE, BATCH.format(axes)))
        rows.append((name, f"{1e6 * timed.median(name) / count:.3g} us", *(f"{ratio:.2f}" for ratio in times)))
    says = (
        f"Time of an axis and step, building models included; {steps} steps of one axis, {few} of {axes} axes on all "
        "cores. By ticks means that the drive's law is Python on arrays of axes, which has to be where a torque is "
        "limited or an effect acts that MuJoCo does not have."
    )
    return [Table(says, ("", "axis and step", "times bare `mj_step`", "times bare batch"), tuple(rows))]
