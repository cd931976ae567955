"""Published values and known truths of other people's recordings."""

import numpy as np
import pytest

from bench.assets import asset
from bench.fit.estimate import modelled_effort
from bench.fit.identify import identify
from bench.rig.rig import Rig, load_rig
from bench.trace.motion import condition, motion
from bench.trace.read import read
from tests.fit.motions import NAMES
from tests.shared import SHARED, needs_shared, null_cases

pytestmark = needs_shared

LIMITS = (1e-3, 1.5e-2, 5e-3)

EMPS = load_rig(asset("data", "rigs", "emps.toml"))
#: Value and three standard deviations, A. Janot, M. Gautier, M. Brunot, NSIB workshop 2019.
PUBLISHED = {
    "moving_mass": (95.1089, 3 * 0.1085),
    "viscous_friction_coefficient": (203.5034, 3 * 1.146),
    "coulomb_friction_force": (20.3935, 3 * 0.101),
    "force_offset": (-3.1648, 3 * 0.044),
}


@pytest.mark.parametrize("name", sorted(null_cases()))
def test_a_case_with_nothing_hidden_gives_its_truth(name):
    folder, truth = SHARED / "cases" / name, null_cases()[name]
    found = identify(read(folder / "run1.csv.gz"), load_rig(folder / "rig.toml"))
    for parameter, key, limit in zip(NAMES, ("inertia", "viscous_friction", "coulomb_friction"), LIMITS, strict=True):
        value, (low, high) = found[parameter].value, found[parameter].ci95
        error, deviation = value / truth[key] - 1.0, (value - truth[key]) / found[parameter].std_error
        inside = "inside" if low <= truth[key] <= high else "outside"
        print(
            f"\n{name} {parameter}: {error:+.4%}, {deviation:+.2f} standard errors, {inside} its 95 % interval", end=""
        )
        assert abs(error) < limit
        assert abs(deviation) < 3.0


def test_emps_gives_the_published_values():
    found = identify(read(SHARED / "data/emps/DATA_EMPS.mat", EMPS.trace.columns), EMPS)
    print(f"\nEMPS force error {found.residual.relative:.4%} (published 4.0834 %)")
    for name, (published, reach) in PUBLISHED.items():
        print(f"{name} {found[name].value:.5g} ({published} +- {reach:.3g})")
        assert abs(found[name].value - published) < reach
    assert found.residual.relative <= 0.0405


def test_pulses_are_explained_by_the_parameters_of_emps():
    found = identify(read(SHARED / "data/emps/DATA_EMPS.mat", EMPS.trace.columns), EMPS)
    trace = read(SHARED / "data/emps/DATA_EMPS_PULSES.mat", EMPS.trace.columns)
    force = EMPS.effort(trace)[0]
    moved = motion(trace, force, force, condition(trace, force))
    modelled = modelled_effort(moved, found, EMPS.axis_kind)
    used = np.isfinite(modelled)
    relative = np.linalg.norm((moved.effort - modelled)[used]) / np.linalg.norm(moved.effort[used])
    print(f"\nPULSES force error with the parameters of EMPS {relative:.4%} (published 5.9824 %)")
    assert relative <= 0.0598


def test_an_axis_of_unknown_torque_constant_is_identified_in_amperes():
    columns = {
        "time": "Time [s]",
        "position": "Position [rad]",
        "velocity": "Velocity [rad/s]",
        "current": "Iq [A]",
        "voltage": "Uq [V]",
    }
    rig = Rig.of({"name": "LAAS", "kind": "rotary", "trace": {"columns": columns}})
    trace = read(SHARED / "data/laas_anticogging/acc_current.txt", columns)
    assert trace.time_base is not None
    found = identify(trace, rig)
    print(f"\nLAAS {[(name, p.value, p.unit) for name, p in found.parameters.items()]}; {trace.time_base}")
    assert found["moment_of_inertia"].unit == "A*s**2/rad"
    assert found["moment_of_inertia"].ci95[0] > 0.0
    assert found["coulomb_friction_torque"].value > 0.0


def test_a_servo_that_reports_its_duty_is_identified_through_its_winding():
    motor = {"torque_constant": "0.387 N*m/A", "resistance": "4.02 ohm"}
    pendulum = {"eccentric_mass": "0.49 kg", "eccentric_radius": "0.1 m"}
    table = {"name": "XL330", "kind": "rotary", "motor": motor, "load": pendulum}
    rig = Rig.of(table)
    trace = read(SHARED / "data/bam_xl330/2026-01-15_10h29m37.json")
    found = identify(trace, rig)
    print(f"\nXL330 {[(name, p.value, p.unit) for name, p in found.parameters.items()]}; {trace.time_base}")
    assert found["moment_of_inertia"].unit == "kg*m**2"
    assert found["moment_of_inertia"].value == pytest.approx(6.7e-3, rel=0.25)


def joint(axis, *names, **more):
    folder = SHARED / "data" / "real" / axis
    rig = load_rig(folder / "rig.toml")
    return identify([read(folder / f"{name}.csv.gz", rig.trace.columns) for name in names], rig, **more)


@pytest.mark.parametrize(
    ("runs", "low", "high"),
    [
        (("pos_006_2", "neg_004_1"), 1.14e-4, 1.18e-4),
        (("pos_006_2", "neg_004_3"), 1.22e-4, 1.25e-4),
        (("pos_006_1", "neg_004_1"), 1.00e-4, 1.07e-4),
        (("pos_006_1", "pos_006_2", "neg_004_1", "neg_004_3"), 1.01e-4, 1.05e-4),
    ],
)
def test_a_stand_whose_runs_go_one_way_gives_the_inertia_of_other_joint_fits(runs, low, high):
    """Own plain least squares of others on the same runs, at about the cut-off that is taken here."""
    found = joint("hsm150", *runs, cutoff=3.0)
    inertia = found["moment_of_inertia"]
    print(f"\n{runs}: J {inertia.value:.4g} {inertia.ci95}, {found.between['moment_of_inertia']}")
    assert inertia.ci95[0] < low and high < inertia.ci95[1]
    assert 0.97 * low < inertia.value < 1.03 * high or len(runs) > 2
    assert all("Coulomb friction torque and torque offset" in alone.reason for alone in found.recordings)
    assert found["coulomb_friction_torque"].value == pytest.approx(0.033, rel=0.1)
    assert found["torque_offset"].value == pytest.approx(0.0066, rel=0.2)
    if len(runs) > 2:
        expected = found.between["moment_of_inertia"].predictive95
        assert expected[0] < 1.00e-4 < 1.25e-4 < expected[1]


def test_rounds_of_one_joint_agree():
    found = joint("damiao_m1", "r1", "r2", "r3")
    assert not any("differ" in warning for warning in found.warnings)
    for alone in found.recordings:
        for name in NAMES:
            low, high = found.between[name].predictive95
            assert low < alone.parameters[name].value < high
    assert found["coulomb_friction_torque"].value == pytest.approx(0.525, abs=0.02)
