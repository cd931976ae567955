"""Running axes: native and ticked ones, the same again, and refusals."""

import dataclasses

import numpy as np
import pytest

from bench.effects.present import Present
from bench.errors import InputError, SimulationError
from bench.plant.drive import Cascade
from bench.plant.plant import Plant
from bench.plant.run import MANY, run, run_loops, run_native, run_ticked
from tests.plant.test_drive import reversals

STRIBECK = Present.of("stribeck_friction", {"static_friction": 0.2, "stribeck_velocity": 1.0})


def test_native_and_ticked_loops_run_in_one_call(plant):
    references = reversals(duration=0.2)
    planned = plant.native_loop(references)
    rising = dataclasses.replace(plant, axis=plant.axis.with_effects([STRIBECK])).native_loop(references)
    assert (planned.native, rising.native) == (True, False)
    expected = run_native(planned), run_ticked(rising), run_native(planned)
    for states, alone in zip(run_loops([planned, rising, planned]), expected, strict=True):
        np.testing.assert_array_equal(states.velocity, alone.velocity)


def test_loops_side_by_side_move_as_each_alone_to_the_last_bit(plant):
    """Of models that differ in all their numbers: friction in numbers, inertia over position, bristles, a spring."""
    references, loops = reversals(duration=0.2), []
    for k in range(MANY):
        effects = [
            Present.of("stribeck_friction", {"static_friction": 0.2 + 0.1 * k, "stribeck_velocity": 1.0 + k}),
            Present.of(
                "position_dependent_inertia", {"relative_amplitude": 0.1 * (1 + k), "harmonic": 1.0, "phase": 0.3 * k}
            ),
            Present.of("presliding_friction", {"bristle_stiffness": 50.0 + 9.0 * k, "bristle_damping": 0.02}),
            Present.of("torsion_spring", {"stiffness": 0.1 * k, "reference": 0.2}),
        ]
        loops.append(dataclasses.replace(plant, axis=plant.axis.with_effects(effects)).native_loop(references))
    for alone, beside in zip(map(run_ticked, loops), run_loops(loops), strict=True):
        np.testing.assert_array_equal(np.stack(alone.signals), np.stack(beside.signals))
    assert len({states.velocity[-1] for states in run_loops(loops)}) == MANY


@pytest.mark.parametrize(("effects", "count"), [((), 1), ((STRIBECK,), 1), ((STRIBECK,), MANY)])
def test_blocks_move_as_the_whole(plant, effects, count):
    """Blocks end between samples of three ticks, and friction has the solver start from where it was."""
    loop = dataclasses.replace(plant, axis=plant.axis.with_effects([*effects])).native_loop(reversals(duration=0.2))
    whole = dataclasses.replace(loop, every=3)
    (expected, *_), (found, *_) = (
        run_loops([dataclasses.replace(whole, block_bytes=size)] * count) for size in (whole.block_bytes, 777)
    )
    np.testing.assert_array_equal(np.stack(found.signals), np.stack(expected.signals))


def test_one_that_diverges_leaves_those_beside_it(plant):
    references, loops = reversals(duration=0.2), []
    for pull in (0.1, 1e12, 0.2):
        effects = [STRIBECK, Present.of("unbalance", {"amplitude": pull, "phase": 0.0})]
        loops.append(dataclasses.replace(plant, axis=plant.axis.with_effects(effects)).native_loop(references))
    assert [one.diverged for one in run_loops(loops)] == [False, True, False]


def test_progress_goes_up_to_one(plant):
    seen = []
    run(dataclasses.replace(plant, emulated=True), reversals(duration=1.0), seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    assert len(seen) > 3


@pytest.mark.parametrize("emulated", [False, True])
def test_divergence_is_an_error_not_a_motion(plant, emulated, capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wild = Cascade(70.0, 60.0, 55.0, 2.2e-3, np.inf, 250e-6)
    with pytest.raises(SimulationError, match="diverged"):
        run(Plant(plant.axis, wild, 250e-6, emulated), reversals())
    assert capfd.readouterr() == ("", "")
    assert not list(tmp_path.iterdir())


def test_refuses_periods_that_do_not_fit(plant):
    with pytest.raises(InputError, match=r"simulation\.timestep: found 0\.0003 s; allowed: the control period"):
        dataclasses.replace(plant, timestep=300e-6)
    with pytest.raises(InputError, match="references"):
        run(plant, reversals(period=500e-6))


def test_a_division_by_zero_is_divergence(plant):
    effect = Present.of("stribeck_friction", {"static_friction": 0.2, "stribeck_velocity": 0.0})
    axis = dataclasses.replace(plant, axis=plant.axis.with_effects([effect]))
    with np.errstate(all="ignore"), pytest.raises(SimulationError, match="diverged"):
        run(axis, reversals(duration=0.05))
