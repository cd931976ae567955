import math

import numpy as np
import pint
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from bench.errors import InputError
from bench.names import nearest
from bench.units import convert, dimensionality, parse
from bench.units.conversion import UnitScale, scale_of
from bench.units.grammar import UnitError


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("22.4 kg*cm**2", "kg*m**2", 22.4e-4),
        ("3000 rpm", "rad/s", 100.0 * math.pi),
        ("180 deg/s", "rad/s", math.pi),
        ("9.84 mN*m", "N*m", 9.84e-3),
        ("20 degC", "K", 293.15),
        ("68 °F", "K", 293.15),
        ("-.5e-3kg", "kg", -0.5e-3),
        ("250 us", "s", 250e-6),
    ],
)
def test_a_value_with_its_unit_becomes_si(text, unit, value):
    assert parse(text, unit, "rig.toml: key") == pytest.approx(value, rel=1e-12)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_any_value_comes_back(value):
    assert parse(f"{value!r} N*m", "N*m", "rig.toml: key") == value


@given(st.text(st.sampled_from("0123456789.eE+-*/^()²⁻³√ mkgNsradA°%µ±"), max_size=30))
@example("1 1e200**2*m")
@example("1 " + "a" * 10_000)
@example("1 " + "(" * 50)
@example("1 s^99999999")
@example("1 10^99999999 s")
@example("1 s**s**s")
@example("1 0 s")
@example("1 \0")
@example("1 s\n")
def test_any_text_is_a_value_or_refused_in_a_short_line(text):
    for unit in ("N*m", "s"):
        try:
            assert math.isfinite(parse(text, unit, "rig.toml: key"))
        except InputError as error:
            assert "\n" not in str(error)
            assert len(str(error)) < 400


@pytest.mark.parametrize("text", ["", "5", "kg", "1,2 kg", "[1] kg", "5 m", "1e999 kg", "nan kg", "5 bananas", 5, None])
def test_a_value_that_is_none_is_refused_with_its_place(text):
    with pytest.raises(InputError, match=r"rig\.toml: key: found .*; allowed: a number with a unit .* kg"):
        parse(text, "kg", "rig.toml: key")


@given(st.floats(-1e12, 1e12))
def test_conversion_there_and_back_is_the_identity(value):
    values = np.array([value])
    assert convert(convert(values, "deg/s", "rad/s"), "rad/s", "deg/s") == pytest.approx(values, rel=1e-12)


def test_angles_count_as_numbers():
    assert dimensionality("deg/s") == dimensionality("1/s")


def test_a_mistyped_name_gets_its_neighbour():
    assert nearest("torque_constnt", ["torque_constant", "resistance"]) == ", did you mean 'torque_constant'?"
    assert nearest("xyz", ["torque_constant"]) == ""


SI = (
    "s m rad A V K N N*m kg kg*m**2 kg/m**3 1/s ohm H rad/s m/s rad/s**2 m/s**2 V*s/rad V*s/m N*m/A N/A N*m/V N/V "
    "N*m*s/rad N*s/m N*m/rad N/m N*m*s**2/rad**2"
)
USUAL = (
    "ms us min mm cm um deg mdeg mrad turn deg/s deg/s**2 rpm mm/s mm/s**2 mA mV mN*m N*cm "
    "mN g mH kg*cm**2 kg*mm**2 g*cm**2 g/cm**3 kg/dm**3 mN*m/A mN*m*s/rad dimensionless hour Hz kHz W kW percent "
    "permille degC krpm A**2*ohm"
)


@pytest.fixture(scope="module")
def registry():
    registry = pint.UnitRegistry(cache_folder=None)
    registry.define("rpm = revolution / minute")
    registry.define("krpm = 1000 * rpm")
    return registry


@pytest.mark.parametrize("unit", f"{SI} {USUAL}".split())
def test_a_usual_unit_is_what_pint_says_it_is(unit, registry):
    one, zero = (registry.Quantity(value, registry.Unit(unit)) for value in (1.0, 0.0))
    found = dimensionality(unit)
    assert (found == "dimensionless") == one.dimensionless
    assert found == "dimensionless" or dict(registry.get_dimensionality(found)) == dict(one.dimensionality)
    si = str(one.to_base_units().units)
    factor = one.to_base_units().magnitude - zero.to_base_units().magnitude
    assert convert(np.array([1.0, 0.0]), unit, si) == pytest.approx(
        [factor + zero.to_base_units().magnitude, zero.to_base_units().magnitude], rel=1e-14
    )


@pytest.mark.parametrize(
    ("unit", "to", "factor"),
    [("horsepower", "W", 745.69987), ("lbf", "N", 4.4482216), ("acre", "m**2", 4046.8726)],
)
def test_a_unit_that_is_not_usual_is_what_pint_says(unit, to, factor):
    assert convert(np.ones(1), unit, to)[0] == pytest.approx(factor, rel=1e-6)


@pytest.mark.parametrize("unit", SI.split())
def test_a_unit_in_si_is_itself(unit):
    values = np.arange(3.0)
    assert convert(values, unit, unit) is values
    assert scale_of(unit, (unit,)) == UnitScale(unit, 1.0)


def test_units_of_different_dimensions_are_not_converted():
    with pytest.raises(ValueError, match="'m' is not a unit of the dimension of s"):
        convert(np.ones(1), "m", "s")


def test_a_temperature_has_no_factor():
    with pytest.raises(UnitError, match=r"found '0\.1 degC'; allowed: degC without a factor, or K"):
        scale_of("0.1 degC", ("K",))


@pytest.mark.parametrize("text", ["1/s", "Hz", "s-1"])
def test_a_speed_of_two_meanings_names_both(text):
    with pytest.raises(UnitError, match="may mean rad/s or rev/s"):
        scale_of(text, ("rad/s", "m/s"))
