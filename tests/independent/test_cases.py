"""Cases on disk: laid out as the shared ones, readable by the bench, identified to their truth."""

import csv
import gzip
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.rig.rig import load_rig
from bench.validation.independent.effects import CATALOGUE, any_effects
from bench.validation.independent.sensors import Noise, Sensors
from tests.cases import hidden, record, residual_ratio, truth, write_case
from tests.outside import OUTSIDE

SHARED = Path(__file__).parents[3] / "shared" / "cases"


def _case(name, effects, seed, linear=False):
    case = hidden(name, effects, (0.5, 0.6), np.random.default_rng(seed), duration=0.4, linear=linear)
    axis = replace(case.axis, control_period=250e-6, top_speed=0.25 * case.axis.top_speed)  # short ramps, short tests
    return replace(case, axis=axis, sensors=replace(case.sensors, sample_period=1e-3))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    home = tmp_path_factory.mktemp("cases")
    cases = [_case("a", (), 1), _case("b", ("elastic_coupling",), 2), _case("c", ("torque_offset",), 3, linear=True)]
    entries = {case.name: write_case(home, case, runs) for case, runs in zip(cases, record(cases, 4), strict=True)}
    (home / "truth.json").write_text(json.dumps(entries))
    return home


def test_files_are_those_of_a_case(folder):
    entries = json.loads((folder / "truth.json").read_text())
    assert sorted(entries) == ["a", "b", "c"]
    for name, entry in entries.items():
        assert sorted(p.name for p in (folder / name).iterdir()) == ["rig.toml", "run1.csv.gz", "run2.csv.gz"]
        rig = load_rig(folder / name / "rig.toml")
        assert rig.axis_kind.turns == (name != "c")
        assert rig.drive is not None
        for run in ("run1", "run2"):
            with gzip.open(folder / name / f"{run}.csv.gz", "rt") as file:
                rows = list(csv.reader(file))
            assert [column.split(" [")[0] for column in rows[0]] == entry["columns"]
            values = np.array(rows[1:], dtype=float)
            assert np.isfinite(values).all()
            assert np.diff(values[:, 0]) == pytest.approx(1.0)
    assert "resonance_frequency" in entries["b"]["parameters"]["elastic_coupling"]
    assert [entries[name]["group"] for name in "abc"] == ["null", "single", "single"]


@pytest.mark.skipif(not SHARED.exists(), reason="the shared cases are not here")
def test_truth_has_the_keys_of_the_shared_cases(folder):
    ours = json.loads((folder / "truth.json").read_text())["b"]
    theirs = next(iter(json.loads((SHARED / "truth.json").read_text()).values()))
    assert ours.keys() == theirs.keys()


@pytest.mark.parametrize("linear", [False, True])
def test_any_effects_can_be_hidden_together(linear):
    rng = np.random.default_rng(0)
    drawn = [any_effects(2, rng, linear=linear) for _ in range(400)]
    allowed = {name for name, kind in CATALOGUE.items() if kind.on_linear_axis or not linear}
    assert set().union(*drawn) == allowed
    assert ("backlash", "elastic_coupling") not in {tuple(sorted(pair)) for pair in drawn}
    assert len(CATALOGUE) == 21
    assert len(OUTSIDE) >= 3


def test_residual_ratio_is_one_with_nothing_hidden_and_above_with_something():
    null, unbalanced = (_case("a", effects, 1) for effects in ((), ("unbalance",)))
    axis = null.axis
    noisy = Sensors(velocity=Noise(white=3e-4 * axis.top_speed), current=Noise(white=2e-2 * axis.peak_current))
    (bare, _), (hit, _) = record([replace(case, sensors=noisy) for case in (null, unbalanced)], seed=1)
    assert residual_ratio(bare) == pytest.approx(1.0, abs=0.25)
    assert residual_ratio(hit) > 2.0
    assert truth(unbalanced, hit)["effects"] == ["unbalance"]
