import math

import numpy as np
import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bench.assets import asset
from bench.errors import InputError
from bench.rig.given import rig_of
from bench.rig.motor import motor_names, motor_sources
from bench.rig.rig import load_rig
from bench.trace.trace import Trace

HEAD = 'name = "axis"\nkind = "rotary"\n'


@pytest.fixture
def rig(tmp_path):
    def load(text, head=HEAD):
        path = tmp_path / "rig.toml"
        path.write_text(head + text, encoding="utf-8")
        return load_rig(path)

    return load


def trace(units=None, **signals):
    known = {"velocity": "rad/s", "current": "A", "torque": "N*m", "voltage": "V", "force": "N"}
    return Trace(np.arange(3.0), {k: np.asarray(v, float) for k, v in signals.items()}, known | (units or {}), "test")


def test_the_embedded_rig_loads_with_motor_from_the_catalogue():
    rig = load_rig(asset("data", "rigs", "sh30701p.toml"))
    constant = rig.motor.torque_per_ampere
    assert constant.torque(np.array([1.8, 5.7])) == pytest.approx([1.4, 3.5])
    assert rig.motor.rotor_inertia == pytest.approx(0.25e-4)


@given(name=st.text(st.characters(exclude_categories=["Cs"])), constant=st.floats(1e-9, 1e9))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_name_and_value_come_back(rig, name, constant):
    written = tomli_w.dumps({"name": name, "kind": "rotary", "motor": {"torque_constant": f"{constant!r} N*m/A"}})
    read = rig(written, head="")
    assert (read.name, read.motor.torque_constant) == (name, constant)


def test_every_catalogue_value_has_a_source():
    for name in motor_names():
        assert all(source for _, source in motor_sources(name).values())


def test_disk_inertia_is_the_ring_integral(rig):
    load = rig(
        '[load]\nouter_diameter="140 mm"\ninner_diameter="14 mm"\nthickness="7.4 mm"\ndensity="7850 kg/m**3"'
    ).load
    radius = np.linspace(0.007, 0.07, 200_001)
    integral = np.trapezoid(2.0 * math.pi * 7850.0 * 0.0074 * radius**3, radius)
    assert load.disk_inertia == pytest.approx(integral, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[motor]\ntorque_constnt = "1 N*m/A"', r"motor\.torque_constnt: unknown key, did you mean 'torque_constant'"),
        ('[motor]\ntorque_constant = "1 N"', r"motor\.torque_constant: found '1 N'; allowed: .*N\*m/A"),
        ("[motor]\ntorque_constant = 1", r"motor\.torque_constant: found 1; allowed: a number with a unit"),
        ('[motor]\nrotor_inertia = "-1 kg*m**2"', r"motor\.rotor_inertia: found '-1 kg\*m\*\*2'; allowed: .*greater"),
        ('[motor]\nmodel = "SH3070P"', r"motor\.model: no motor 'SH3070P' in the catalogue, did you mean 'SH30701P'"),
        ('[motor]\nmoving_mass = "1 kg"', r"moving_mass does not belong to a rotary axis"),
        ('[motor]\ncontinuous_stall_torque = "1 N*m"', r"kT\(Iq\) takes the four datasheet values; missing"),
        ('[load]\nouter_diameter = "1 m"', r"either mass or density"),
        ('[drive]\nposition_gain="1 1/s"\nvelocity_gain="3 N*s/m"', r"drive\.velocity_gain: found '3 N\*s/m'"),
        ("motor = 3", r"motor: found 3; allowed"),
        ("x = [", r"not TOML"),
        ("typo = 1", r"typo: unknown key; allowed: name, kind"),
    ],
)
def test_a_wrong_rig_is_refused_naming_file_key_found_and_allowed(rig, text, message):
    with pytest.raises(InputError, match=message) as caught:
        rig(text)
    assert "rig.toml" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_name_and_kind_may_be_left_to_the_file_and_its_motor(rig):
    assert (rig("", head="").name, rig("", head="").kind) == ("rig", "rotary")
    assert rig('[motor]\nmoving_mass = "2 kg"\n', head="").kind == "linear"
    with pytest.raises(InputError, match=r"kind: found 'round'; allowed: .*'rotary' or 'linear'"):
        rig("", head='name = "axis"\nkind = "round"\n')


def test_a_missing_rig_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"nowhere\.toml: no such file"):
        load_rig(tmp_path / "nowhere.toml")
    with pytest.raises(InputError, match="found a folder"):
        load_rig(tmp_path)


MOTOR = '[motor]\ntorque_constant = "0.5 N*m/A"\nrated_torque = "2 N*m"\nresistance = "4 ohm"'


@pytest.mark.parametrize(
    ("text", "signals", "units", "effort", "unit"),
    [
        (MOTOR, {"current": 2}, {}, 1, "N*m"),
        (MOTOR, {"torque": 3, "current": 9}, {}, 3, "N*m"),
        (MOTOR, {"torque": 0.5}, {"torque": "dimensionless"}, 1, "N*m"),
        (MOTOR, {"voltage": 8}, {}, [1.0, 0.9375, 0.875], "N*m"),
        ("", {"current": [1, 2, 3]}, {}, [1, 2, 3], "A"),
        ("", {"voltage": [1, 2, 3]}, {}, [1, 2, 3], "V"),
    ],
)
def test_effort_comes_from_what_is_recorded(rig, text, signals, units, effort, unit):
    """K_t*(U - K_e*w)/R of a voltage; without a constant it stays in its own unit."""
    filled = {name: np.broadcast_to(values, 3) for name, values in signals.items()}
    found, of = rig(text).effort(trace(units, velocity=[0, 1, 2], **filled))
    assert found == pytest.approx(np.broadcast_to(effort, 3))
    assert of == unit


def test_a_rig_may_be_given_as_a_table_a_file_or_itself(rig, tmp_path):
    loaded = rig(MOTOR)
    assert rig_of(loaded) is loaded
    assert rig_of(tmp_path / "rig.toml").motor == loaded.motor
    assert rig_of({"motor": {"torque_constant": "0.5 N*m/A"}}).motor.torque_constant == 0.5


def test_stated_inertia_is_that_of_motor_and_load_where_both_are_stated(rig):
    rotor, load = '[motor]\nrotor_inertia = "2 kg*cm**2"\n', '[load]\nouter_diameter = "0.2 m"\nmass = "1 kg"\n'
    assert rig(rotor + load).stated_inertia == pytest.approx(2e-4 + 0.5 * 1.0 * 0.1**2)
    assert [rig(text).stated_inertia for text in (rotor, load)] == [None, None]


def test_a_joints_own_values_replace_those_for_all(rig):
    both = rig(
        '[motor]\ntorque_constant = "0.5 N*m/A"\n[joints.elbow]\ntorque_constant = "0.7 N*m/A"\ngear_ratio = 8.0'
    )
    assert both.of_joint("wrist") is both
    elbow = both.of_joint("elbow")
    assert (elbow.motor.torque_constant, elbow.load.gear_ratio) == (0.7, 8.0)
    kept = rig('[motor]\ntorque_constant = "0.5 N*m/A"\n[joints.elbow]\ngear_ratio = 8.0').of_joint("elbow")
    assert kept.motor.torque_constant == 0.5


def test_a_trace_of_the_other_kind_of_axis_is_noticed(rig):
    with pytest.raises(InputError, match="found a linear axis; allowed: a rotary one"):
        rig("").effort(trace({"velocity": "m/s"}, velocity=[0, 1, 2], current=[1, 2, 3]))
    with pytest.raises(InputError, match="contains no current, torque, force or voltage"):
        rig("").effort(trace(velocity=[0, 1, 2]))
