"""The examples run as they stand, from an empty folder, and print what is true."""

import re
import runpy

import pytest

from bench.assets import asset
from bench.plant.simulate import simulate
from bench.rig.rig import load_rig
from tests.docs.pages import DOCS

EXAMPLES = {path.stem: path for path in sorted((DOCS / "examples").glob("*.py"))}
MOST_LINES = 40
NUMBER = r"([-+.\de]+)"


@pytest.fixture(scope="session")
def inertia():
    """Of the shipped rig's axis - kg*m**2."""
    return simulate(load_rig(asset("data", "rigs", "sh30701p.toml"))).truth.parameters.inertia


@pytest.fixture
def printed(tmp_path, monkeypatch, capsys):
    def run(name):
        monkeypatch.chdir(tmp_path)
        runpy.run_path(str(EXAMPLES[name]), run_name="__main__")
        return capsys.readouterr().out

    return run


def number(pattern, text):
    return float(re.search(pattern.replace("NUMBER", NUMBER), text)[1])


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_is_short_and_has_a_test(name):
    text = EXAMPLES[name].read_text(encoding="utf-8")
    assert len(text.splitlines()) <= MOST_LINES
    assert f"test_{name}" in globals()


def test_identify_a_csv(printed, inertia):
    text = printed("identify_a_csv")
    assert number("^moment_of_inertia: NUMBER", text) == pytest.approx(inertia, rel=2e-3)
    assert number("coulomb_friction_torque: NUMBER", text) == pytest.approx(0.085, rel=5e-3)


def test_several_recordings(printed, inertia):
    text = printed("several_recordings")
    assert number("moment_of_inertia: NUMBER", text) == pytest.approx(inertia, rel=1e-3)
    assert number("expected from NUMBER", text) < inertia < number("expected from .* to NUMBER", text)


def test_data_frame(printed):
    text = printed("data_frame")
    assert number("moment_of_inertia: NUMBER", text) == pytest.approx(1.5e-3, rel=2e-3)
    assert number("coulomb_friction_torque: NUMBER", text) == pytest.approx(0.06, rel=2e-2)


def test_hide_and_find(printed):
    text = printed("hide_and_find")
    assert text.startswith("explained\n")
    assert number("amplitude: NUMBER", text) == pytest.approx(0.05, rel=2e-2)
    assert number("harmonic: NUMBER", text) == 6.0
    assert number("NUMBER after", text) < 0.2 * number("NUMBER N.m before", text)


def test_check_for_change(printed):
    as_it_was, worn = printed("check_for_change").splitlines()
    assert as_it_was == "as it was: same, appeared: []"
    assert worn.startswith("worn: changed") and "cogging_torque" in worn


def test_plan_a_motion(printed, tmp_path):
    text = printed("plan_a_motion")
    shares = [float(share) for share in re.findall(r"standard error ([\d.]+)%", text)]
    assert shares == sorted(shares) and shares[0] < 1.0
    rows = (tmp_path / "motion.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) - 1 == number("NUMBER rows", text)


def test_step_effects_in_a_loop(printed):
    weak, middle, strong = re.findall(r": ([-\d.]+) rad/s", printed("step_effects_in_a_loop"))
    assert abs(float(weak)) < 1e-3
    assert abs(float(middle)) < 1e-3, "above Coulomb friction and below static friction it sticks"
    assert float(strong) > 1.0


def test_batch_of_a_hundred(printed):
    assert number("moves one: NUMBER N", printed("batch_of_a_hundred")) == pytest.approx(0.17, abs=0.006)


def test_fleet_of_recordings(printed):
    text = printed("fleet_of_recordings")
    assert "'done': 8" in text
    explained = {(axis, day): float(share) for axis, day, share in re.findall(r"(\w+) (\S+): ([\d.]+) of", text)}
    assert min(explained, key=explained.__getitem__) == ("saw", "2026-01-04")


def test_joint_of_a_robot(printed):
    text = printed("joint_of_a_robot")
    assert number("armature: NUMBER", text) == pytest.approx(0.02, rel=1e-2)
    assert number("coulomb_friction_torque: NUMBER", text) == pytest.approx(0.4, rel=1e-2)


def test_effect_of_your_own(printed):
    text = printed("effect_of_your_own")
    assert number("noise NUMBER without", text) > 1.5
    assert number("NUMBER with", text.split("without")[1]) == pytest.approx(1.0, abs=0.1)
    assert number("rate of NUMBER", text) == pytest.approx(0.01, rel=0.02)


def test_reader_of_your_own(printed):
    assert printed("reader_of_your_own") == "1000 samples, 0.001 s between samples, up to 313.85 rad/s\n"
