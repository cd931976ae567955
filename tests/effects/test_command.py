"""Effects on the command line."""

import json

import pytest

from bench.assets import asset
from bench.axis_kind import LINEAR
from bench.effects.catalogue import catalogue
from bench.effects.present import parse_effect
from bench.errors import InputError
from bench.plant.simulate import simulate
from bench.rig.rig import load_rig
from tests.command import bench
from tests.effects.axes import VALUES
from tests.plant.conftest import RIG


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("cogging_torque:amplitude=0.05,harmonic=6", {"amplitude": 0.05, "harmonic": 6.0}),
        ("cogging_torque: amplitude = 50 mN*m , phase=90 deg", {"amplitude": 0.05, "phase": 1.5707963}),
        ('current_loop_lag:time_constant="2 ms"', {"time_constant": 2e-3}),
        ("stribeck_friction:stribeck_velocity=60 rpm", {"stribeck_velocity": 6.2831853}),
    ],
)
def test_values_with_and_without_units(text, values):
    assert dict(parse_effect(text).values) == pytest.approx(values)


def test_linear_axes_take_metres_and_newtons():
    found = parse_effect("stribeck_friction:static_friction=30 N,stribeck_velocity=5 mm/s", LINEAR)
    assert dict(found.values) == pytest.approx({"static_friction": 30.0, "stribeck_velocity": 5e-3})


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("coging_torque:amplitude=1", "did you mean 'cogging_torque'"),
        ("cogging_torque:amplitud=1", "did you mean 'amplitude'"),
        ("cogging_torque:amplitude", "key=value"),
        ("cogging_torque:amplitude=much", "number with a unit"),
        ("cogging_torque:amplitude=1 kg", "dimension of N"),
        ("cogging_torque:amplitude=-1", "0 to inf"),
        ("cogging_torque:amplitude=inf", "finite"),
    ],
)
def test_what_cannot_be_read_is_reported(text, says):
    with pytest.raises(InputError, match=says):
        parse_effect(text)


def test_simulate_writes_the_truth_of_its_effects(tmp_path):
    rig, out = tmp_path / "rig.toml", tmp_path / "run.csv.gz"
    rig.write_text(RIG.format(simulation="", motor=""), encoding="utf-8")
    effects = (
        "--effect",
        "cogging_torque:amplitude=50 mN*m,harmonic=6",
        "--effect",
        "velocity_filter_lag:time_constant=1 ms",
    )
    code, _, error = bench("simulate", rig, "--out", out, "--profile", "multisine", *effects)
    assert (code, error) == (0, "")
    truth = json.loads((tmp_path / "run.csv.gz.truth.json").read_text(encoding="utf-8"))
    assert [effect["name"] for effect in truth["effects"]] == ["cogging_torque", "velocity_filter_lag"]
    assert truth["effects"][0]["parameters"]["amplitude"] == {"value": 0.05, "unit": "N*m"}


@pytest.mark.parametrize(
    ("effect", "says"),
    [
        ("cogging_torque:amplitude=1", "harmonic missing"),
        ("voltage_limit:voltage=50", "resistance"),
        ("backlash:gap=0.1,contact_stiffness=x", "number with a unit"),
    ],
)
def test_simulate_refuses_in_one_line_and_writes_nothing(tmp_path, effect, says):
    rig, out = tmp_path / "rig.toml", tmp_path / "run.csv.gz"
    rig.write_text(RIG.format(simulation="", motor=""), encoding="utf-8")
    code, _, error = bench("simulate", rig, "--out", out, "--profile", "multisine", "--effect", effect)
    assert code == 2
    assert says in error
    assert error.count("\n") == 1
    assert not out.exists()


def test_friction_acts_in_the_mechanics_where_the_drive_makes_that_of_the_rig(tmp_path):
    """The recording is that of the same rig with friction in its mechanics, and both user and truth are told."""
    effect, recordings = "load_dependent_friction:load_friction_coefficient=0.1", []
    for friction in ("drive", "mechanics"):
        rig, out = tmp_path / f"{friction}.toml", tmp_path / f"{friction}.csv"
        rig.write_text(RIG.format(simulation=f'friction = "{friction}"', motor=""), encoding="utf-8")
        code, _, error = bench("simulate", rig, "--out", out, "--profile", "multisine", "--effect", effect)
        warned = "all friction acts in the mechanics, as load_dependent_friction needs"
        assert (code, warned in error) == (0, friction == "drive")
        assert json.loads((tmp_path / f"{out.name}.truth.json").read_text(encoding="utf-8"))["friction"] == "mechanics"
        recordings.append(out.read_text(encoding="utf-8"))
    assert recordings[0] == recordings[1]


def test_each_effect_is_simulated_on_the_axis_of_the_course():
    """But a voltage limit, which needs a winding that the course's motor has not."""
    lab = load_rig(asset("data", "rigs", "lab.toml"))
    for name, values in VALUES.items():
        if name != "voltage_limit":
            found = simulate(lab, "multisine", effects={name: values})
            chatters = any("chatters" in warning for warning in found.warnings)
            assert chatters == (name in ("elastic_coupling", "backlash")), (name, found.warnings)


def test_every_effect_is_listed_and_has_a_page():
    code, table, _ = bench("effects")
    assert code == 0
    for name, effect in catalogue().items():
        assert name in table
        code, page, _ = bench("effects", name)
        assert code == 0
        assert "Simulated\n    " in page
        assert all(quantity.name in page for quantity in effect.quantities)


def test_unknown_effect_has_no_page():
    code, _, error = bench("effects", "coging")
    assert code == 2
    assert "allowed: backlash" in error
