"""Running axes: a thousand as one, the same again, and refusals."""

import dataclasses

import numpy as np
import pytest

from bench.effects.present import Present
from bench.errors import InputError, SimulationError
from bench.plant.drive import Cascade
from bench.plant.plant import Plant
from bench.plant.run import run, run_native, run_ticked
from tests.plant.test_drive import reversals


def test_a_thousand_axes_move_as_one(plant):
    references = reversals(duration=0.05)
    loop = plant.ticked_loop(references)
    together, alone = run_ticked([loop] * 1000), run_ticked([loop])
    for name in ("position", "velocity", "torque"):
        np.testing.assert_array_equal(getattr(together, name), np.repeat(getattr(alone, name), 1000, axis=1))


def test_native_and_ticked_axes_run_in_one_call(plant):
    emulated = dataclasses.replace(plant, emulated=True)
    references = [reversals(duration=0.2), reversals(duration=0.2), reversals(duration=0.2, speed=200.0)]
    states = run([plant, emulated, plant], references)
    np.testing.assert_array_equal(states.axis(0).velocity, run_native(plant.native_loop(references[0])).velocity)
    np.testing.assert_array_equal(states.axis(1).velocity, run_ticked([emulated.ticked_loop(references[1])]).velocity)
    np.testing.assert_array_equal(states.axis(2).velocity, run_ticked([plant.ticked_loop(references[2])]).velocity)


def test_runs_again_the_same(plant):
    references = reversals(duration=0.3)
    np.testing.assert_array_equal(run([plant], [references]).velocity, run([plant], [references]).velocity)


def test_progress_goes_up_to_one(plant):
    seen = []
    run([dataclasses.replace(plant, emulated=True)], [reversals(duration=1.0)], seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    assert len(seen) > 3


@pytest.mark.parametrize("emulated", [False, True])
def test_divergence_is_an_error_not_a_motion(plant, emulated, capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wild = Cascade(70.0, 60.0, 55.0, 2.2e-3, np.inf, 250e-6)
    with pytest.raises(SimulationError, match="diverged"):
        run([Plant(plant.axis, wild, 250e-6, emulated)], [reversals()])
    assert capfd.readouterr() == ("", "")
    assert not list(tmp_path.iterdir())


def test_refuses_periods_that_do_not_fit(plant):
    with pytest.raises(InputError, match=r"simulation\.timestep: found 0\.0003 s; allowed: the control period"):
        dataclasses.replace(plant, timestep=300e-6)
    with pytest.raises(InputError, match="references"):
        run([plant], [reversals(period=500e-6)])
    other = dataclasses.replace(plant, cascade=dataclasses.replace(plant.cascade, control_period=500e-6))
    with pytest.raises(InputError, match="tick together"):
        run([plant, other], [reversals(), reversals(period=500e-6)])


def test_a_lone_axis_diverges_as_axes_side_by_side_do(plant):
    """Its values are numbers, and a Stribeck velocity of nothing divides by it all the same."""
    effect = Present.of("stribeck_friction", {"static_friction": 0.2, "stribeck_velocity": 0.0})
    axis = dataclasses.replace(plant, axis=plant.axis.with_effects([effect]))
    for count in (1, 2):
        with np.errstate(all="ignore"), pytest.raises(SimulationError, match="diverged"):
            run([axis] * count, [reversals(duration=0.05)] * count)
