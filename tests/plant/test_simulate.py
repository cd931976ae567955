"""The whole simulation of a rig: what is recorded obeys the truth that is written."""

import json

import numpy as np
import pytest

from bench.errors import InputError
from bench.plant.axis_model import AxisParameters
from bench.plant.profiles import PROFILES
from bench.plant.simulate import simulate, truth_path, write_truth
from bench.rig.rig import Load, load_rig


def torque_error(simulated):
    """Worst mean of M - J*alpha - K_w*w - K_0*sgn(w) - M_L over 10 ms of motion one way - N*m; number of windows."""
    truth, states = simulated.truth.parameters, simulated.states
    period = simulated.references.period
    velocity, position = states.velocity, states.position
    impulse = np.append(0.0, np.cumsum(states.torque[:-1])) * period
    window = 40
    ends = np.arange(window, len(velocity), window)
    starts = ends - window
    sign = np.sign(velocity) * (np.abs(velocity) > 0.1)
    steady = np.array([abs(sign[a : b + 1].sum()) == window + 1 for a, b in zip(starts, ends, strict=True)])
    a, b = starts[steady], ends[steady]
    rest = (
        truth.inertia * (velocity[b] - velocity[a])
        + truth.viscous_friction_coefficient * (position[b] - position[a])
        + (truth.coulomb_friction * sign[a] + truth.load_torque) * window * period
    )
    return float(np.abs(impulse[b] - impulse[a] - rest).max() / (window * period)), int(steady.sum())


@pytest.mark.parametrize("profile", PROFILES)
def test_motion_obeys_the_equation_of_motion(rig_of, profile):
    simulated = simulate(rig_of('load_torque = "0.1 N*m"'), profile)
    worst, windows = torque_error(simulated)
    print(f"{profile}: worst torque balance {worst:.1e} N*m over {windows} windows of 10 ms")
    assert windows > 20
    assert worst < 1e-5


def test_full_torque_reaches_peak_current(rig_of):
    simulated = simulate(rig_of(), "full_torque")
    assert simulated.trace["current"].max() == pytest.approx(5.0, rel=1e-9)
    assert (simulated.trace["current"] > 4.999).sum() > 50


def test_seed_repeats_the_recording(rig_of):
    rig = rig_of('velocity_noise = "1.5 deg/s"\ncurrent_noise = "5 mA"')
    first, again, other = (simulate(rig, "slow_reversals", seed=seed).trace for seed in (3, 3, 4))
    for name in first.signals:
        np.testing.assert_array_equal(first[name], again[name])
    assert (first["velocity"] != other["velocity"]).all()


def test_samples_come_at_the_sample_period(rig_of):
    trace = simulate(rig_of('sample_period = "2 ms"'), "slow_reversals").trace
    assert trace.sample_period == pytest.approx(2e-3)
    assert set(trace.signals) == {"position", "velocity", "current", "position_reference", "velocity_reference"}


def test_friction_of_drive_and_mechanics_give_one_recording(rig_of):
    rig = 'friction = "{}"\ncurrent_noise = "5 mA"'
    mechanics, drive = (simulate(rig_of(rig.format(kind)), "multisine") for kind in ("mechanics", "drive"))
    assert drive.truth.friction == "drive"
    off = np.abs(mechanics.trace["current"] - drive.trace["current"]).max()
    print(f"current with friction in the drive against mechanics: {off:.1e} A")
    assert off < 2e-3
    assert np.abs(drive.states.torque - drive.states.motor_torque).max() > 0.08


def test_gear_reflects_inertia_and_load_torque(rig_of):
    rig = rig_of('load_torque = "0.5 N*m"')
    assert AxisParameters.from_rig(rig).load_torque == 0.5
    load = {"outer_diameter": "200 mm", "mass": "4 kg", "gear_ratio": 5.0, "gear_inertia": "0.1 kg*cm**2"}
    simulation = rig.simulation.model_copy(update={"moment_of_inertia": None})
    geared = rig.model_copy(update={"load": Load.model_validate(load), "simulation": simulation})
    parameters = AxisParameters.from_rig(geared)
    assert parameters.load_torque == pytest.approx(0.1)
    assert parameters.motor_inertia == pytest.approx(0.35e-4)
    assert parameters.inertia == pytest.approx(0.35e-4 + 4.0 * 0.2**2 / 8.0 / 25.0)


def test_linear_axis_runs_within_its_stroke(tmp_path):
    path = tmp_path / "linear.toml"
    path.write_text(LINEAR, encoding="utf-8")
    simulated = simulate(load_rig(path))
    assert not simulated.trace.axis_kind.turns
    assert 0.05 < np.ptp(simulated.trace["position"]) < 0.21
    assert torque_error(simulated)[0] < 1e-4
    truth = json.loads(simulated.truth.as_json())
    assert truth["parameters"]["moving_mass"] == {"value": 95.0, "unit": "kg"}
    assert truth["parameters"]["coulomb_friction_force"]["unit"] == "N"


LINEAR = """
name = "slide"
kind = "linear"
[motor]
force_constant = "35 N/A"
peak_current = "10 A"
[load]
stroke = "20 cm"
[drive]
position_gain = "40 1/s"
velocity_gain = "15000 N*s/m"
integral_gain = "200000 N/m"
inertia_feedforward = "90 kg"
[simulation]
moving_mass = "95 kg"
viscous_friction_coefficient = "200 N*s/m"
coulomb_friction = "20 N"
encoder_resolution = "1 um"
"""


def test_truth_stands_beside_the_trace(rig_of, tmp_path):
    simulated = simulate(rig_of(), "slow_reversals", seed=7)
    path = write_truth(tmp_path / "run.csv.gz", simulated.truth)
    assert path == truth_path(tmp_path / "run.csv.gz")
    assert path.name == "run.csv.gz.truth.json"
    truth = json.loads(path.read_text())
    assert truth["parameters"]["moment_of_inertia"] == {"value": pytest.approx(2.2e-3), "unit": "kg*m**2"}
    assert truth["parameters"]["coulomb_friction_torque"]["value"] == pytest.approx(0.085)
    assert (truth["seed"], truth["profile"], truth["friction"]) == (7, "slow_reversals", "mechanics")


@pytest.mark.parametrize("table", ["drive", "simulation"])
def test_says_what_the_rig_lacks(rig_of, table):
    with pytest.raises(InputError, match=rf"{table}: missing"):
        simulate(rig_of().model_copy(update={table: None}))


def test_refuses_a_rotor_heavier_than_the_whole(rig_of):
    rig = rig_of()
    heavy = rig.model_copy(update={"motor": rig.motor.model_copy(update={"rotor_inertia": 1.0})})
    with pytest.raises(InputError, match="moment_of_inertia"):
        simulate(heavy)


def test_friction_that_falls_towards_standstill_is_no_stribeck_friction():
    with pytest.raises(InputError, match=r"stribeck_friction\.static_friction: found 0.04 N\*m; allowed: from 0.085"):
        simulate("sh30701p", effects="stribeck_friction:static_friction=0.04,stribeck_velocity=4")


def test_a_drive_chatters_from_the_gain_that_makes_its_velocity_loop_unstable(rig_of):
    """Each control period leaves 1 - K_v*T/J of a speed error, so it alternates and grows from K_v*T/J = 2 on."""
    rig = rig_of("")
    inertia, drive = AxisParameters.from_rig(rig).inertia, rig.drive
    limit = 2.0 * inertia / drive.control_period
    for share, chatters in ((0.9, False), (1.1, True)):
        gains = {"velocity_gain": share * limit, "integral_gain": 0.0}
        found = simulate(rig.model_copy(update={"drive": drive.model_copy(update=gains)}), "multisine")
        assert any("chatters" in warning for warning in found.warnings) == chatters
        if chatters:
            assert f"it removes {2.0 * share:.2g} times the speed error" in found.warnings[0]


def test_an_axis_that_does_not_follow_its_profile_is_reported(rig_of):
    """A torque above the motor's largest drags the axis away."""
    sound, dragged = (simulate(rig_of(), "multisine", effects=[f"torque_offset:torque={load}"]) for load in (0.1, 9.0))
    assert sound.warnings == ()
    assert any("does not follow its profile" in warning and "100 %" in warning for warning in dragged.warnings)
