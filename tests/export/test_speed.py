"""What effects cost in a simulation of one's own: `pytest -m slow tests/export/test_speed.py -s`."""

from time import process_time

import mujoco
import pytest
from mujoco.batch import Batch

import bench
from bench.export.mjcf import onto
from tests.effects.axes import VALUES
from tests.export.arms import ARM, stored

NATIVE = ("cogging_torque",)
ONE = ("stribeck_friction",)
FIVE = (
    "direction_dependent_friction",
    "friction_warmup",
    "position_dependent_inertia",
    "stribeck_friction",
    "torque_ripple",
)
STEPS, COPIES = 20_000, 200


def taken(step, count):
    """Seconds of processor that a step takes, the least of three."""
    times = []
    for _ in range(3):
        start = process_time()
        for _ in range(count):
            step()
        times.append((process_time() - start) / count)
    return min(times)


@pytest.mark.slow
@pytest.mark.parametrize("names", [NATIVE, ONE, FIVE], ids=["native", "one stepped", "five stepped"])
def test_cost_of_a_step(names):
    model = stored(*((name, VALUES[name]) for name in names))
    spec = mujoco.MjSpec.from_string(ARM)
    bare = spec.compile()
    onto(spec, "elbow", model)
    arm, effects = spec.compile(), bench.Effects(model, "elbow")
    data, plain = mujoco.MjData(arm), mujoco.MjData(bare)
    many, others = Batch(arm, COPIES, nthread=1), Batch(bare, COPIES, nthread=1)
    copies = effects.on(many)
    alone = taken(lambda: mujoco.mj_step(bare, plain), STEPS), taken(lambda: effects.step(arm, data), STEPS)
    side = taken(others.step, STEPS // COPIES) / COPIES, taken(copies.step, STEPS // COPIES) / COPIES
    for what, (without, with_effects) in (("one", alone), (f"{COPIES} copies", side)):
        ratio = with_effects / without
        print(f"\n{what}: {1e6 * without:.2f} us, with effects {1e6 * with_effects:.2f} us, {ratio:.2f} times", end="")
    assert side[1] < alone[1]
