"""Runs of a validation: what is hidden in which axis along which motion, drawn or one's own."""

import numpy as np
import pytest

from bench.assets import asset
from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.rig.rig import Rig, load_rig
from bench.trace.trace import Trace
from bench.validation.independent.effects import KINDS
from bench.validation.plan import HIDEABLE, Hiding, Plan, Sampled, motion_of, own_axis
from bench.validation.validate import TOGETHER, carried_out, pieces, record, validate
from tests.fit.motions import Truth, recording
from tests.validation.population import short

PLAN = Plan(5, population=short)


def test_a_case_depends_on_seed_and_index_alone():
    few = [PLAN.case(index) for index in (3, 1)]
    again = [PLAN.case(index) for index in range(4)]
    assert [case.axis for case in few] == [again[3].axis, again[1].axis]
    assert [case.sensors for case in few] == [again[3].sensors, again[1].sensors]
    assert Plan(6, population=short).case(1).axis != few[1].axis


def test_a_recording_is_the_same_bit_for_bit_alone_and_beside_others():
    cases = [PLAN.case(index) for index in range(6)]
    assert {case.plant for case in cases} == {"independent", "mujoco"}
    together = record(cases, PLAN.seed)
    for place in (0, 2, 5):
        (alone,) = record([cases[place]], PLAN.seed)
        assert alone.signals.keys() == together[place].signals.keys()
        assert all(np.array_equal(alone[name], together[place][name]) for name in alone.signals)


def test_pieces_hold_every_run_once():
    assert [index for piece in pieces(2 * TOGETHER + 3) for index in piece] == list(range(2 * TOGETHER + 3))


@pytest.mark.usefixtures("worker_processes")
def test_what_is_reported_in_a_process_of_its_own_is_what_is_reported_here():
    shares = []
    found = validate(PLAN, 3, workers=1, progress=shares.append)
    assert found.runs == tuple(carried_out(PLAN, range(3)))
    assert shares == [1.0]


def test_names_are_hidden_in_turn_and_then_nothing():
    hiding = Hiding.parse("unbalance, backlash")
    axis, rng = PLAN.case(0).axis, np.random.default_rng(0)
    drawn = [hiding.drawn(index, rng, axis) for index in range(4)]
    assert drawn == [("unbalance",), ("backlash",), (), ("unbalance",)]
    assert Hiding.parse("all").names == HIDEABLE
    assert set(HIDEABLE) <= set(catalogue()) & set(KINDS)


def test_so_many_are_hidden_as_asked():
    rng = np.random.default_rng(0)
    axis = PLAN.case(0).axis
    counts = {len(Hiding.parse("1-3").drawn(index, rng, axis)) for index in range(40)}
    assert counts == {1, 2, 3}
    assert Hiding.parse("0").anything is False


@pytest.mark.parametrize("text", ["3-1", "9", "backlsh", "", "1-"])
def test_what_cannot_be_hidden_is_reported(text):
    with pytest.raises(InputError, match="allowed"):
        Hiding.parse(text)


DRIVE = {"position_gain": "30 1/s", "velocity_gain": "0.15 N*m*s/rad", "integral_gain": "3 N*m/rad"}
TABLE = {
    "name": "own",
    "kind": "rotary",
    "motor": {"torque_constant": "0.8 N*m/A", "peak_current": "8 A", "rotor_inertia": "2 kg*cm**2"},
    "drive": DRIVE,
}


def test_a_sampled_motion_starts_and_ends_at_rest_and_goes_through_its_speeds():
    time = np.linspace(2.0, 3.0, 201)
    motion = Sampled(time, 5.0 + 3.0 * np.sin(12.0 * time))
    dense = np.linspace(0.0, motion.duration, 4001)
    position, speed, acceleration = motion.at(dense)
    assert speed[[0, -1]] == pytest.approx([0.0, 0.0])
    assert np.interp(0.1 + 0.5, dense, speed) == pytest.approx(5.0 + 3.0 * np.sin(12.0 * 2.5), abs=1e-3)
    assert np.gradient(position, dense) == pytest.approx(speed, abs=0.05)
    assert position[-1] == pytest.approx(motion.distance)
    assert np.trapezoid(acceleration, dense) == pytest.approx(0.0, abs=1e-2)


def test_the_motion_is_the_reference_where_there_is_one():
    made = recording(np.random.default_rng(2), duration=2.0)
    reference = np.sin(made.time)
    units = {"velocity": "rad/s", "current": "A", "velocity_reference": "rad/s"}
    with_reference = Trace(made.time, {**made.signals, "velocity_reference": reference}, units, "with_reference")
    assert motion_of(with_reference).top == pytest.approx(np.abs(reference).max())
    assert motion_of(made).top == pytest.approx(np.abs(made["velocity"]).max(), rel=0.05)


def test_what_the_rig_does_not_say_the_recording_does():
    truth = Truth()
    own = own_axis(Rig.of(TABLE), "monday.csv", recording(np.random.default_rng(1), truth, duration=10.0))
    assert [own.case.axis.inertia, own.case.axis.coulomb] == pytest.approx([truth.inertia, truth.coulomb], rel=0.02)
    assert own.case.sensors.velocity.white == pytest.approx(0.03, rel=0.1)
    assert own.case.sensors.current.white == pytest.approx(0.01 / 0.8, rel=0.1)
    assert own.plants == ("independent", "mujoco")
    assert own.case.axis.back_emf_constant == 0.0  # so that no voltage limit is hidden in it


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"drive": None}, "drive"),
        ({"motor": {"torque_constant": "0.8 N*m/A"}}, "peak_current"),
        ({"load": {"eccentric_mass": "0.1 kg", "eccentric_radius": "10 mm"}}, "eccentric_mass"),
    ],
)
def test_what_a_rig_lacks_is_reported(change, expected):
    table = {key: value for key, value in (TABLE | change).items() if value is not None}
    with pytest.raises(InputError, match=expected):
        own_axis(Rig.of(table), "monday.csv", recording(np.random.default_rng(1), duration=10.0))


def test_a_motor_that_saturates_is_mujocos_alone():
    own = own_axis(load_rig(asset("data", "rigs", "sh30701p.toml")), "fast_reversals", None)
    assert own.case.rig.motor.torque_per_ampere is not None
    assert own.plants == (("mujoco",) if own.case.rig.motor.torque_per_ampere.curvature else ("independent", "mujoco"))
