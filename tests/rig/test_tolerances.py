"""Tolerances of a rig's values: read with the value, counted by intervals; constants of two motors are reported."""

import copy
import pickle

import numpy as np
import pytest

from bench.arrays import NORMAL95
from bench.errors import InputError
from bench.fit.identify import identify
from bench.gate.gate import warnings_of
from bench.rig.rig import Rig, load_rig
from bench.rig.values import tolerance_of
from bench.units import parse_with_tolerance
from tests.fit.motions import recording

FRICTION = ("viscous_friction_coefficient", "coulomb_friction_torque")


def rig(**motor):
    return Rig.of({"name": "axis", "kind": "rotary", "motor": motor})


@pytest.mark.parametrize(
    ("text", "value", "tolerance"),
    [
        ("0.78 +/- 0.04 N*m/A", 0.78, 0.04),
        ("780 ± 40 mN*m/A", 0.78, 0.04),
        ("7.8e-1+/-4e-2 N*m/A", 0.78, 0.04),
        ("0.78 N*m/A", 0.78, 0.0),
    ],
)
def test_a_value_and_its_tolerance_are_read_in_one_unit(text, value, tolerance):
    found = parse_with_tolerance(text, "N*m/A", "here")
    assert found == pytest.approx((value, tolerance))
    motor = rig(torque_constant=text).motor
    assert motor.torque_constant == pytest.approx(value)
    assert tolerance_of(motor.torque_constant) == pytest.approx(tolerance)


def test_a_temperature_s_tolerance_is_a_difference():
    assert parse_with_tolerance("20 +/- 5 degC", "K", "here") == pytest.approx((293.15, 5.0))


@pytest.mark.parametrize("text", ["0.78 +/- N*m/A", "0.78 +/- 0.04", "0.78 +/- 0.04 N", "0.78 +/- -0.04 N*m/A"])
def test_what_is_no_tolerance_is_refused_naming_the_key(tmp_path, text):
    path = tmp_path / "rig.toml"
    path.write_text(f'name = "a"\nkind = "rotary"\n[motor]\ntorque_constant = "{text}"\n', encoding="utf-8")
    with pytest.raises(InputError, match=r"motor\.torque_constant: found '0\.78"):
        load_rig(path)


def test_a_tolerance_travels_to_another_process():
    motor = rig(torque_constant="0.8 +/- 0.04 N*m/A").motor
    for other in (pickle.loads(pickle.dumps(motor)), copy.deepcopy(motor)):
        assert tolerance_of(other.torque_constant) == pytest.approx(0.04)


@pytest.mark.parametrize(
    ("motor", "share"),
    [
        ({"torque_constant": "0.8 +/- 0.04 N*m/A"}, 0.05),
        ({"torque_constant": "0.8 N*m/A", "back_emf_constant": "0.64 V*s/rad"}, 0.2),
    ],
    ids=["a tolerance", "constants that disagree"],
)
def test_intervals_count_what_is_not_known_of_the_torque_constant(motor, share):
    """M = kT*I: every coefficient is proportional to kT, so 5 % of one is 5 % of the other; by Ke a fifth."""
    trace = recording(np.random.default_rng(0))
    sharp, wide = (identify(trace, rig(**values)) for values in ({"torque_constant": "0.8 N*m/A"}, motor))
    for name in ("moment_of_inertia", *FRICTION):
        own, found = sharp[name], wide[name]
        assert found.value == own.value
        half, before = found.ci95[1] - found.value, own.ci95[1] - own.value
        assert half == pytest.approx(np.hypot(before, share * found.value), rel=1e-3)
        assert found.std_error == pytest.approx(np.hypot(own.std_error, share / NORMAL95 * found.value), rel=1e-3)


def test_datasheet_values_and_the_rotor_s_inertia_count_too():
    trace = recording(np.random.default_rng(1))
    plain = {"continuous_stall_current": "2 A", "peak_torque": "6 N*m", "peak_current": "8 A"}
    toleranced = {"continuous_stall_torque": "1.6 +/- 0.08 N*m", "rotor_inertia": "2 +/- 0.5 kg*cm**2"}
    found = identify(trace, rig(**toleranced, **plain))
    inertia, load = found["moment_of_inertia"], found["load_moment_of_inertia"]
    assert inertia.std_error > 0.02 * inertia.value
    assert load.value == pytest.approx(inertia.value - 2e-4)
    half = load.ci95[1] - load.value
    assert half == pytest.approx(np.hypot(inertia.ci95[1] - inertia.value, 0.5e-4), rel=1e-6)


@pytest.mark.parametrize(
    ("constant", "back_emf", "reported"),
    [
        ("0.8 N*m/A", "0.8 V*s/rad", False),
        ("0.8 N*m/A", "0.74 V*s/rad", False),
        ("0.8 N*m/A", "0.533 V*s/rad", False),
        ("0.8 N*m/A", "0.462 V*s/rad", False),
        ("0.8 N*m/A", "0.64 V*s/rad", True),
        ("0.8 +/- 0.02 N*m/A", "0.74 V*s/rad", True),
        ("0.8 +/- 0.02 N*m/A", "0.74 +/- 0.07 V*s/rad", False),
    ],
)
def test_constants_of_two_motors_are_reported(constant, back_emf, reported):
    found = identify(recording(np.random.default_rng(2)), rig(torque_constant=constant, back_emf_constant=back_emf))
    check = next(check for check in found.checks if check.name == "motor_constants_agree")
    assert check.status == ("warn" if reported else "pass")
    assert any("back-EMF constant" in warning for warning in warnings_of(found.checks)) == reported
