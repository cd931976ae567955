import math

import numpy as np
import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bench.assets import asset
from bench.errors import InputError
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


def test_effort_comes_from_what_is_recorded(rig):
    motor = '[motor]\ntorque_constant = "0.5 N*m/A"\nrated_torque = "2 N*m"\nresistance = "4 ohm"'
    axis = rig(motor)
    assert axis.effort(trace(velocity=[0, 1, 2], current=[2, 2, 2]))[0] == pytest.approx([1, 1, 1])
    assert axis.effort(trace(velocity=[0, 1, 2], torque=[3, 3, 3], current=[9, 9, 9]))[0] == pytest.approx([3, 3, 3])
    share = trace({"torque": "dimensionless"}, velocity=[0, 1, 2], torque=[0.5, 0.5, 0.5])
    assert axis.effort(share)[0] == pytest.approx([1, 1, 1])
    by_voltage, unit = axis.effort(trace(velocity=[0, 4, 8], voltage=[8, 8, 8]))
    assert by_voltage == pytest.approx([1.0, 0.75, 0.5])
    assert unit == "N*m"


def test_without_a_constant_the_effort_stays_in_its_own_unit(rig):
    assert rig("").effort(trace(velocity=[0, 1, 2], current=[1, 2, 3]))[1] == "A"
    assert rig("").effort(trace(velocity=[0, 1, 2], voltage=[1, 2, 3]))[1] == "V"


def test_a_trace_of_the_other_kind_of_axis_is_noticed(rig):
    with pytest.raises(InputError, match="found a linear axis; allowed: a rotary one"):
        rig("").effort(trace({"velocity": "m/s"}, velocity=[0, 1, 2], current=[1, 2, 3]))
    with pytest.raises(InputError, match="contains no current, torque, force or voltage"):
        rig("").effort(trace(velocity=[0, 1, 2]))
