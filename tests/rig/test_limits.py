"""The operating range at its corners, and the reserve of motions that can be reckoned by hand."""

import numpy as np
import pytest

from bench.assets import asset
from bench.errors import InputError
from bench.rig.limits import OperatingRange, peak_curve, reserve
from bench.rig.rig import load_rig

RPM = 60.0 / (2.0 * np.pi)


@pytest.fixture
def motor():
    return load_rig(asset("data", "rigs", "lab.toml")).motor


@pytest.fixture
def low(motor):
    """Of the lower mains voltage."""
    return OperatingRange.of(motor, 230.0, "rig")


def rpm(*values):
    return np.array(values) / RPM


def test_peak_torque_is_flat_to_the_corner_and_falls_to_zero(motor, low):
    high = OperatingRange.of(motor, 400.0, "rig")
    assert low.peak(rpm(0, 2100, 3550, 5000, 6000)) == pytest.approx([3.5, 3.5, 1.75, 0.0, 0.0])
    assert high.peak(rpm(0, 2100, 4200)) == pytest.approx([3.5, 3.5, 3.5])
    assert low.peak(-rpm(3550)) == pytest.approx([1.75])


def test_continuous_torque_falls_slightly_and_never_passes_the_peak(low):
    torque = low.continuous(rpm(0, 2500, 4900))
    assert torque[:2] == pytest.approx([1.4, 1.4 * 0.95])
    assert torque[2] == pytest.approx(low.peak(rpm(4900))[0])


def test_reserve_of_a_motion_by_hand(low):
    found = reserve(low, rpm(3550, 3550, 0, 0), np.array([1.0, -3.0, 0.0, 0.0]))
    # driving, 1.75 - 1.0 are left; braking, where voltage helps, 3.5 - 3.0
    assert found.peak == pytest.approx(0.5)
    assert found.at == 1
    assert found.beyond == 0.0
    assert found.rms_torque == pytest.approx(np.sqrt(10.0 / 4.0))
    assert found.mean_speed * RPM == pytest.approx(1775.0)
    # kT = c + a*I**2 through 1.4 N*m at 1.8 A and 3.5 N*m at 5.7 A; current by the roots of a polynomial
    a = (3.5 / 5.7 - 1.4 / 1.8) / (5.7**2 - 1.8**2)
    c = 1.4 / 1.8 - a * 1.8**2

    def current(torque):
        roots = np.roots([a, 0.0, c, -torque])
        return min(root.real for root in roots if abs(root.imag) < 1e-9 and root.real > 0.0)

    effective = np.sqrt((current(1.0) ** 2 + current(3.0) ** 2) / 4.0)
    assert found.rms_current == pytest.approx(effective)
    assert found.thermal == pytest.approx(current(1.4 * (1.0 - 0.1 * 1775.0 / 5000.0)) - effective)
    over = reserve(low, rpm(4000, 0), np.array([2.0, 0.1]))
    assert over.peak < 0.0
    assert over.beyond == 0.5


def test_what_is_missing_is_named(motor):
    with pytest.raises(InputError, match="230 V, 400 V"):
        peak_curve(motor, 115.0, "rig")
    with pytest.raises(InputError, match="peak_torque"):
        OperatingRange.of(motor.model_copy(update={"peak_torque": None}), 230.0, "rig")


@pytest.mark.parametrize(
    ("curve", "words"),
    [
        ('corner_speed = "5000 rpm", no_load_speed = "2100 rpm"', ["peak_curves", "below"]),
        ('corner_speed = "2 A", no_load_speed = "5000 rpm"', ["corner_speed", "2 A"]),
        ('knee = "2100 rpm", no_load_speed = "5000 rpm"', ["corner_speed"]),
        (
            'corner_speed = "21 rpm", no_load_sped = "1 rpm", no_load_speed = "50 rpm"',
            ["no_load_sped", "no_load_speed"],
        ),
    ],
)
def test_a_bad_curve_in_a_rig_file_is_named(tmp_path, curve, words):
    path = tmp_path / "rig.toml"
    curves = f'[{{ mains_voltage = "230 V", {curve} }}]'
    path.write_text(f'name = "a"\nkind = "rotary"\n[motor]\npeak_curves = {curves}\n')
    with pytest.raises(InputError) as error:
        load_rig(path)
    assert [word for word in words if word not in str(error.value)] == []
    assert "\n" not in str(error.value)


def test_a_cold_winding_has_its_corner_higher_and_the_same_ends(motor, low):
    cold = low.cold(motor, "rig")
    # R falls to 70 %: n_0 - 0.7*(n_0 - n_c)
    assert cold.curve.corner_speed * RPM == pytest.approx(5000.0 - 0.7 * 2900.0)
    assert cold.peak(rpm(0, 5000)) == pytest.approx(low.peak(rpm(0, 5000)))
    assert (cold.continuous_torque, cold.loss) == (low.continuous_torque, low.loss)
