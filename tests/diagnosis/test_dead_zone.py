"""The gap of a dead zone is found however wide it is beside the way that the motor goes in a filter's width."""

import numpy as np
import pytest

from bench.diagnosis.recordings import fit_bare
from bench.effects.backlash import likeliest_shape
from bench.fit.rows import Rows
from bench.rig.rig import load_rig
from bench.validation.independent.effects.mechanics import Backlash
from bench.validation.independent.references import random_motion
from bench.validation.independent.rig import Axis, write_rig
from bench.validation.independent.sensors import Noise, Sensors
from bench.validation.independent.simulate import simulate
from tests.kept import kept

AXIS = Axis("axis", 1e-3, 6e-4, 0.08, 3.5e-4, 0.8, 5.0, velocity_gain=0.12, integral_gain=2.0)
SENSORS = Sensors(velocity=Noise(white=0.01), current=Noise(white=5e-3))
SEED, STEP = 5, 62.5e-6
#: A contact of 80 Hz against the load, of a fifth of critical damping.
STIFFNESS, DAMPING = 6.5e-4 * (2.0 * np.pi * 80.0) ** 2, 0.2 * 2.0 * 6.5e-4 * 2.0 * np.pi * 80.0
GAPS = (0.012, 0.08, 0.25)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """The rig, and a recording by the gap in it."""
    path = tmp_path_factory.mktemp("rig") / "rig.toml"
    write_rig(AXIS, path)
    motion = random_motion(AXIS, np.random.default_rng(SEED), 5.0)
    effects = [(Backlash(wide, STIFFNESS, DAMPING),) for wide in GAPS]
    count = len(GAPS)
    together = [AXIS] * count, [motion] * count, effects, [SENSORS] * count
    runs = kept(
        lambda: [run.trace for run in simulate(*together, SEED, numbers=[0] * count, longest_step=STEP)], __file__
    )
    return load_rig(path), dict(zip(GAPS, runs, strict=True))


@pytest.mark.parametrize("wide", GAPS)
def test_a_gap_is_found(recorded, wide):
    rig, traces = recorded
    bare = fit_bare(Rows.of(traces[wide], rig))
    way = bare.scope.rms_speed * bare.scope.width
    found = likeliest_shape(bare, lambda gain: True)
    print(f"gap of {wide / way:.2g} ways: {found[0] / wide - 1.0:+.1%}, contact {found[1] / 2 / np.pi:.0f} Hz")
    assert found[0] == pytest.approx(wide, rel=0.03)
