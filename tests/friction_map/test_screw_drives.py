"""Friction over speed of published screw drives; `-s` prints the figures, docs/validation.md has them."""

import pytest

from bench.assets import asset
from bench.errors import UndeterminedError
from bench.friction_map import friction_map
from bench.rig.rig import load_rig
from bench.trace.read import read
from tests.shared import SHARED, needs_shared

pytestmark = [needs_shared, pytest.mark.slow]

SCREWS = load_rig(asset("data", "rigs", "tro2021.toml"))


def steady_speeds(drive):
    """Recordings of one screw drive, each at one speed."""
    files = sorted((SHARED / f"data/tro2021_screw/driveNo{drive}/steady_state").rglob("*.csv"))
    return [read(path, SCREWS.trace.columns) for path in files]


@pytest.mark.parametrize(("drive", "name"), [(1, "stribeck_friction"), (2, None), (3, None)])
def test_the_lead_screw_alone_has_stribeck_friction(drive, name):
    """IEEE T-RO 37(4), 2021: drive 1 has it, drives 2 and 3 have none."""
    found = friction_map(steady_speeds(drive), SCREWS)
    before, after = found.unexplained
    print(f"\nscrew drive {drive}: {found.name} {found.values}, unexplained {before:.4f} -> {after:.4f},", end=" ")
    print(f"chance {found.probability:.2g}", end="")
    assert found.name == name
    if name is not None:
        assert found.probability < 1e-9
        assert 2.0 < found.values["stribeck_velocity"] < 7.0


def test_few_steady_speeds_tell_nothing():
    with pytest.raises(UndeterminedError, match="at least 8 different speeds in each direction"):
        friction_map(steady_speeds(1)[:6], SCREWS)
