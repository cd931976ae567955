"""The baseline on disk comes back as it was written, and says what is wrong with it."""

import re
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.assets import asset
from bench.baseline.model import INSTANTS, Response
from bench.baseline.state import LEAST, MOST, read_baseline, write_baseline
from bench.comparison.difference import Measured
from bench.errors import InputError
from tests.baseline.states import named, state


def test_a_state_comes_back(tmp_path):
    effect = named("cogging_torque", 0.03, ["torque_ripple"], amplitude=0.05, harmonic=6.0, phase=1.0)
    before = state(None, [replace(effect, gain=120.0)], "explained")
    several = Measured(0.0613, "N*m", 2e-4, 31.2, 5, 7e-4)
    before = replace(before, quantities={**before.quantities, "coulomb_friction_torque": several})
    write_baseline(tmp_path / "b.toml", before)
    assert read_baseline(tmp_path / "b.toml") == before
    text = (tmp_path / "b.toml").read_text(encoding="utf-8")
    assert 'value = "0.0613 N*m"' in text
    assert text.count("not determined by fewer than two recordings") == 7


def test_a_state_of_an_earlier_version_has_its_spreads(tmp_path):
    """Of one recording they are not known, in whichever words it says so; the shipped one is such a state."""
    shipped = asset("data", "baselines", "sh30701p.toml")
    assert "not told by fewer than two recordings" in shipped.read_text(encoding="utf-8")
    spreads = {name: quantity.spread for name, quantity in read_baseline(shipped).quantities.items()}
    assert spreads["torque_gap"] is None
    assert spreads["moment_of_inertia"] > 0.0


SIZES = st.floats(LEAST, MOST)


@given(SIZES | SIZES.map(lambda size: -size) | st.just(0.0), SIZES, st.text(st.characters(exclude_categories=["Cs"])))
def test_any_number_and_any_name_come_back(tmp_path_factory, value, error, name):
    """Numbers to nine digits, which are more than any comparison needs."""
    before = state()
    friction = Measured(value, "N*m", error, 31.2, 5, error)
    traces = [{"file": name, "sha256": name}]
    before = replace(
        before,
        quantities={**before.quantities, "coulomb_friction_torque": friction},
        provenance={"version": name, "traces": traces, name or "empty": name},
        rig={"kind": "rotary", name or "empty": name},
    )
    path = tmp_path_factory.mktemp("named") / "b.toml"
    write_baseline(path, before)
    again = read_baseline(path)
    found = again.quantities["coulomb_friction_torque"]
    for there, here in ((value, found.value), (error, found.std_error), (error, found.spread)):
        assert here == pytest.approx(there, rel=1e-8, abs=0.0)
    assert (again.provenance, again.rig) == (before.provenance, before.rig)


def test_a_model_comes_back(tmp_path):
    before = replace(state(), source="model", shows=None, response=Response(1e-3, 50.0, (0.1,) * INSTANTS))
    write_baseline(tmp_path / "b.toml", before)
    assert read_baseline(tmp_path / "b.toml") == before


WRONG = {
    "bench.baseline/1": ("bench.baseline/2", "schema"),
    'value = "0.06 N*m"': ('value = "much"', "quantities.coulomb_friction_torque.value: found 'much'"),
    'std_error = "0.0002 N*m"': ('std_error = "-1 N*m"', "below zero"),
    'std_error = "3e-07 kg*m**2"': ('std_error = "1e300 kg*m**2"', "moment_of_inertia.std_error: found 1e+300"),
    'std_error = "3e-06 N*m*s/rad"': ('std_error = "1e-320 N*m*s/rad"', "std_error: found 1e-320"),
    'rms_speed = "60 rad/s"': ("", "conditions.rms_speed: missing"),
    "[gap.torque]": ("[gap.other]", "gap.torque: missing"),
    "gain = 120.0": ('gain = "much"', "effects[0].gain: found 'much'"),
    "recordings = 1": ('recordings = "one"', "recordings: found 'one'"),
    'name = "cogging_torque"': ('name = "cogging"', "did you mean 'cogging_torque'"),
    "names = true": ("", "names: missing"),
    'left = "0.0025 N*m"': ("left = nan", "shows.left"),
    "[rig]": ("[rigs]", "rig: found 3"),
}


@pytest.mark.parametrize("there", WRONG)
def test_what_is_wrong_is_one_line(there, tmp_path):
    path = tmp_path / "b.toml"
    effect = replace(named("cogging_torque", 0.03, amplitude=0.05, harmonic=6.0), gain=120.0)
    write_baseline(path, state(None, [effect]))
    text = path.read_text(encoding="utf-8")
    instead, message = WRONG[there]
    assert there in text
    text = text.replace(there, instead)
    if there == "[rig]":  # a key of the file, before its first table
        text = f"rig = 3\n{text}"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=re.escape(str(path))) as refused:
        read_baseline(path)
    assert message in str(refused.value)


def test_no_baseline_says_how_to_make_one(tmp_path):
    with pytest.raises(InputError, match="--update"):
        read_baseline(tmp_path / "none.toml")
