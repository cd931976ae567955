import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from bench.errors import InputError
from bench.names import nearest
from bench.units import base_units, convert, dimensionality, parse, registry
from bench.units.usual import USUAL_UNITS


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("22.4 kg*cm**2", "kg*m**2", 22.4e-4),
        ("3000 rpm", "rad/s", 100.0 * math.pi),
        ("180 deg/s", "rad/s", math.pi),
        ("9.84 mN*m", "N*m", 9.84e-3),
        ("20 degC", "K", 293.15),
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
def test_any_text_is_a_value_or_refused_in_a_line(text):
    try:
        assert math.isfinite(parse(text, "N*m", "rig.toml: key"))
    except InputError as error:
        assert "\n" not in str(error)


@pytest.mark.parametrize("text", ["", "5", "kg", "1,2 kg", "[1] kg", "5 m", "1e999 kg", "nan kg", "5 bananas", 5, None])
def test_a_value_that_is_none_is_refused_with_its_place(text):
    with pytest.raises(InputError, match=r"rig\.toml: key: found .*; allowed: a number with a unit .* kg"):
        parse(text, "kg", "rig.toml: key")


@given(st.floats(-1e12, 1e12))
def test_conversion_there_and_back_is_the_identity(value):
    values = np.array([value])
    assert convert(convert(values, "deg/s", "rad/s"), "rad/s", "deg/s") == pytest.approx(values, rel=1e-12)


def test_conversion_to_the_same_unit_copies_nothing():
    values = np.arange(3.0)
    assert convert(values, "A", "A") is values


def test_angles_count_as_numbers():
    assert dimensionality("deg/s") == dimensionality("1/s")


def test_a_mistyped_name_gets_its_neighbour():
    assert nearest("torque_constnt", ["torque_constant", "resistance"]) == ", did you mean 'torque_constant'?"
    assert nearest("xyz", ["torque_constant"]) == ""


@pytest.mark.parametrize("unit", USUAL_UNITS)
def test_a_usual_unit_is_what_pint_says_it_is(unit):
    assert dimensionality(unit) == registry.dimensionality(unit)
    assert base_units(unit) == registry.base_units(unit)
    for to, wanted in USUAL_UNITS.items():
        if wanted.dimensionality == USUAL_UNITS[unit].dimensionality:
            factor, offset = registry.affine(unit, to)
            assert offset == 0.0
            assert convert(np.ones(1), unit, to)[0] == factor
