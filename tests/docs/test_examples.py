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
