"""Numbers and units as a person reads them."""

import pytest

from bench.parameter import Parameter
from bench.report.html import ticks
from bench.report.numbers import brief, interval, listed, number, share, unit_text


def plain(text):
    return text.replace("\N{NO-BREAK SPACE}", " ")


@pytest.mark.parametrize(
    ("shown", "value", "half", "unit", "text"),
    [
        (interval, 0.0501, 0.00022, "N*m", "0.05010 ± 0.00022 N·m"),
        (interval, 0.00131, 1.2e-6, "kg*m**2", "(1.3100 ± 0.0012)·10⁻³ kg·m²"),
        (interval, -3.1648, 0.05, "N", "−3.165 ± 0.050 N"),
        (interval, 95.1089, 0.4, "kg", "95.11 ± 0.40 kg"),
        (interval, 6.0, 0.0, "dimensionless", "6"),
        (interval, 123456.0, 789.0, "N", "(123.46 ± 0.79)·10³ N"),
        (interval, 2.0, 150.0, "rad/s**2", "2 ± 150 rad/s²"),
        (interval, 0.0, 0.1, "N", "0.00 ± 0.10 N"),
        (interval, -0.000274, 0.00349, "kg*m**2", "−0.0003 ± 0.0035 kg·m²"),
        (brief, 0.04996, 0.00021, "N*m", "0.0500 N·m ± 0.42 %"),
        (brief, 2.25003e-3, 1.3e-7, "kg*m**2", "0.00225 kg·m² ± 0.0058 %"),
        (brief, 123456.0, 789.0, "N", "1.23·10⁵ N ± 0.64 %"),
        (brief, 199.4, 2.0, "N", "199 N ± 1 %"),
        (brief, -0.7, 1.8, "N", "−0.7 ± 1.8 N"),
        (brief, 6.0, 0.0, "dimensionless", "6"),
    ],
)
def test_a_value_has_as_many_digits_as_its_interval_and_in_brief_three(shown, value, half, unit, text):
    assert plain(shown(Parameter(value, unit, half / 1.96, (value - half, value + half)))) == text


@pytest.mark.parametrize("shown", [interval, brief])
def test_of_what_is_known_up_to_a_factor_both_ends_are_given(shown):
    found = Parameter(740.57, "N*m/rad", 583.5, (119.7, 4581.8))
    assert plain(shown(found)) == "741 (120 to 4600) N·m/rad"
    assert str(found) == "741 (1.2e+02 to 4.6e+03) N*m/rad"
    near = Parameter(1.46e-3, "kg*m**2", 1e-5, (1.457e-3, 1.512e-3))
    assert plain(shown(near)) == "0.00146 (0.00146 to 0.00151) kg·m²"
    little = Parameter(740.57, "N*m/rad", 58.0, (661.0, 829.7))  # a factor of 1.12
    assert "±" in shown(little) and "±" in str(little)


@pytest.mark.parametrize(
    ("found", "text"),
    [
        (number(0.0278, "rad/s", 3), "0.0278 rad/s"),
        (number(-1.5, "rad/s", 3), "−1.5 rad/s"),
        (number(1.9e-33, "rad/s", 3), "1.9·10⁻³³ rad/s"),
        (number(float("nan"), "rad/s", 3), "not known"),
        *((share(value), text) for value, text in ((0.87, "87 %"), (0.0123, "1.2 %"), (0.0, "0 %"), (-0.2, "−20 %"))),
        (share(1e-6), "< 0.1 %"),
        *((unit_text(unit), text) for unit, text in (("kg*m**2", "kg·m²"), ("N*m*s/rad", "N·m·s/rad"), ("1/s", "1/s"))),
        (unit_text("dimensionless"), ""),
        (unit_text("V*s**-1"), "V·s⁻¹"),
        *((listed("abc"[:n]), text) for n, text in enumerate(("", "a", "a and b", "a, b and c"))),
    ],
)
def test_a_number_a_share_a_unit_and_names_in_a_row(found, text):
    assert plain(found) == text


def test_labels_of_an_axis_say_their_value():
    for low, high in ((-0.05, 0.05), (0.0, 6.28), (-160.0, 160.0), (3.0, 3.01), (-2e-5, 3e-5), (0.0, 4e6)):
        found = ticks(low, high, 5)
        assert 2 <= len(found) <= 7
        step = found[1][0] - found[0][0]
        for value, label in found:
            assert low <= value <= high
            assert float(label.replace("−", "-")) == pytest.approx(value, abs=0.01 * step)
