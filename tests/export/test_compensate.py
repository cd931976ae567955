"""Tables for a drive: what they hold, against closed forms, and how much better an axis tracks that is a little off."""

from dataclasses import replace

import numpy as np
import pytest

from bench.assets import asset
from bench.effects.present import Present
from bench.export.feedforward import DriveUnits, Feedforward, TorqueTable, feedforward, resisting_torque, tracking
from bench.plant.drive import References
from bench.plant.plant import Plant
from bench.plant.profiles import MotionLimits, plan
from bench.rig.rig import Rig, load_rig
from tests.effects.axes import PARAMETERS, VALUES, model

RIG = load_rig(asset("data", "rigs", "sh30701p.toml"))
HIDDEN = {
    "cogging_torque": {"amplitude": 0.05, "harmonic": 6.0, "phase": 0.4},
    "stribeck_friction": {"static_friction": 0.12, "stribeck_velocity": 2.0},
}
Q = np.linspace(-4.0, 9.0, 40)
W = 8.0 * np.sin(np.arange(40.0))
K0, KW = PARAMETERS.coulomb_friction, PARAMETERS.viscous_friction_coefficient

#: Torque of each effect in steady motion beside K_0 and K_w, by its equation.
STEADY = {
    "cogging_torque": lambda v: v["amplitude"] * np.sin(v["harmonic"] * Q + v["phase"]),
    "unbalance": lambda v: v["amplitude"] * np.sin(Q + v["phase"]),
    "torsion_spring": lambda v: v["stiffness"] * (Q - v["reference"]),
    "torque_offset": lambda v: v["torque"],
    "quadratic_drag": lambda v: v["quadratic_drag"] * W * np.abs(W),
    "stribeck_friction": lambda v: (
        (v["static_friction"] - K0) * np.exp(-((W / v["stribeck_velocity"]) ** 2)) * np.sign(W)
    ),
    "direction_dependent_friction": lambda v: 0.5 * (v["coulomb_difference"] + v["viscous_difference"] * np.abs(W)),
    **dict.fromkeys(
        ("presliding_friction", "friction_warmup", "load_torque_event", "torque_ripple", "elastic_coupling"),
        lambda v: 0.0,
    ),
}


@pytest.mark.parametrize("name", STEADY)
def test_what_resists_is_what_the_equations_say(name):
    expected = KW * W + K0 * np.sign(W) + STEADY[name](VALUES[name])
    np.testing.assert_allclose(resisting_torque(model(name), Q, W), expected, atol=1e-9)


def test_tracking_errors_are_at_least_halved_with_a_model_that_is_off():
    """The axis is the truth; the tables are of a model whose every value is 3 % too large or too small."""
    plant = Plant.from_rig(RIG, [Present.of(name, values) for name, values in HIDDEN.items()])
    true = plant.axis.parameters
    known = replace(true, inertia=0.97 * true.inertia, coulomb_friction=1.03 * true.coulomb_friction)
    off = [
        Present.of(
            name, {key: value * (1.0 if key in ("harmonic", "phase") else 0.97) for key, value in values.items()}
        )
        for name, values in HIDDEN.items()
    ]
    guess = replace(plant.model, parameters=known, effects=tuple(off))
    motion = plan("slow_reversals", MotionLimits.from_rig(RIG, known, plant.cascade.control_period))
    tables = feedforward(guess, float(np.abs(motion.velocity).max()), (-10.0, 10.0))
    before, after = tracking(plant.model, RIG, motion), tracking(plant.model, RIG, motion, tables)
    print(f"\n{before} -> {after}")
    assert after.position < 0.5 * before.position
    assert after.velocity < 0.5 * before.velocity


def test_what_the_tables_do_not_hold_is_named():
    tables = feedforward(model("torque_ripple", "cogging_torque", "current_loop_lag"), 20.0, (-1.0, 1.0))
    assert set(tables.left) == {"torque_ripple", "current_loop_lag"}
    assert tables.cogging.period == pytest.approx(2.0 * np.pi)


def test_torque_over_position_is_the_mean_of_both_directions():
    """Cogging stands in both directions, friction that varies with position turns its sign and is none of it."""
    tables = feedforward(model("cogging_torque", "position_dependent_friction"), 20.0, (-1.0, 1.0))
    at, values = tables.cogging.coordinate, VALUES["cogging_torque"]
    cogging = values["amplitude"] * np.sin(values["harmonic"] * at + values["phase"])
    np.testing.assert_allclose(tables.cogging.torque, cogging, atol=1e-9)
    # over a whole turn what varies with position has no mean
    speeds = tables.friction.coordinate
    np.testing.assert_allclose(tables.friction.torque, KW * speeds + K0 * np.sign(speeds), atol=1e-9)


def test_a_constant_torque_stands_once_over_speed_and_none_over_position():
    tables = feedforward(model("torque_offset"), 20.0, (-1.0, 1.0))
    np.testing.assert_allclose(tables.cogging.torque, 0.0, atol=1e-12)
    assert tables.friction(np.array([10.0, -10.0])) == pytest.approx([10.0 * KW + K0 - 0.12, -10.0 * KW - K0 - 0.12])


def test_references_get_the_torque_of_both_tables():
    tables = feedforward(model("cogging_torque"), 20.0, (-1.0, 1.0))
    speed, place, values = np.array([5.0, -5.0]), np.array([0.3, 0.9]), VALUES["cogging_torque"]
    cogging = values["amplitude"] * np.sin(values["harmonic"] * place + values["phase"])
    along = tables.along(References(np.array([0.0, 1e-3]), place, speed, np.zeros(2)))
    np.testing.assert_allclose(along.torque, KW * speed + K0 * np.sign(speed) + cogging, atol=1e-4)
    assert along.feedforward(tables.inertia) == pytest.approx(along.torque)


COLUMNS = {"velocity": "Axis.Vel [rpm]", "position": "-Axis.Pos [deg]", "current": "Axis.Iq [mA]"}
UNITS = DriveUnits.of(
    Rig.of({"name": "a", "kind": "rotary", "motor": {"torque_constant": "0.5 N*m/A"}, "trace": {"columns": COLUMNS}})
)


def test_the_inertias_feedforward_is_in_the_units_of_the_drive():
    """1e-3 kg*m**2 at 0.5 N*m/A are 2 mA per rad/s**2, of which a rpm/s is 2*pi/60."""
    nothing = TorqueTable(np.zeros(1), np.zeros(1))
    (_, inertia, unit), (_, current, per) = UNITS.inertia(Feedforward(1e-3, nothing, nothing, ()))
    assert (inertia, unit) == (1e-3, "kg*m**2")
    assert (current, per) == (pytest.approx(2.0 * 2.0 * np.pi / 60.0), "mA/(rpm/s)")


def test_a_table_is_in_the_units_of_the_drive():
    table = TorqueTable(np.array([0.0, np.pi]), np.array([0.0, 0.25]))
    speed, place = UNITS.table("velocity", UNITS.velocity, table), UNITS.table("position", UNITS.position, table)
    assert speed == "velocity [rpm],torque [N*m],current [mA]\n0,0,0\n30,0.25,500\n"
    assert place == "position [deg],torque [N*m],current [mA]\n-180,0.25,500\n-0,0,0\n"


def test_a_torque_that_does_not_repeat_itself_spans_the_travel():
    tables = feedforward(model("torsion_spring"), 20.0, (-3.0, 5.0))
    assert tables.cogging.period is None
    assert tables.cogging.coordinate[0] == -3.0
    slope = np.polyfit(tables.cogging.coordinate, tables.cogging.torque, 1)[0]
    assert slope == pytest.approx(VALUES["torsion_spring"]["stiffness"], rel=1e-6)
