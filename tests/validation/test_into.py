"""What becomes of effects that are put into a recording, and how the least that is named is sought."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.errors import InputError, UndeterminedError
from bench.parameter import Parameter
from bench.validation.coverage import of_effects
from bench.validation.independent.effects import CoggingTorque
from bench.validation.into import Injection, Injections, Own, axis_of, fate, inject, own, tried
from tests.sines import sines
from tests.validation.test_injection import AXIS, RIG, SWING, host_of

OWN = Own(host_of(SWING, np.zeros(SWING.size)), ("unbalance",), "explained", frozenset({"unbalance"}), 0.01, "N*m")
CASE = Injection("cogging_torque", 2.0, "amplitude", 0.05, "N*m", 0.035)


def found(verdict, *names, ambiguous=()):
    amplitude = Parameter(0.051, "N*m", 1e-3, (0.049, 0.053))
    effects = [
        SimpleNamespace(
            name=name, effect=catalogue()[name], ambiguous_with=ambiguous, parameters={"amplitude": amplitude}
        )
        for name in names
    ]
    return SimpleNamespace(verdict=verdict, effects=effects)


@pytest.mark.parametrize(
    ("verdict", "names", "became", "new"),
    [
        ("explained", ("unbalance", "cogging_torque"), "right", ("cogging_torque",)),
        ("unexplained_remainder", ("cogging_torque",), "right", ("cogging_torque",)),
        ("explained", ("cogging_torque", "backlash"), "part", ("cogging_torque", "backlash")),
        ("explained", ("cogging_torque", "unbalance", "unbalance"), "part", ("cogging_torque", "unbalance")),
        ("unexplained_remainder", ("unbalance",), "flagged", ()),
        ("explained", ("unbalance",), "missed", ()),
        ("nothing_missing", (), "missed", ()),
        ("unexplained_remainder", ("torque_ripple",), "wrong", ("torque_ripple",)),
    ],
)
def test_what_becomes_of_an_effect(verdict, names, became, new):
    diagnosis = found(verdict, *names)
    assert fate(diagnosis, "cogging_torque", OWN.names) == (became, new)
    named = "cogging_torque" in new
    assert replace(CASE, fate=became).named is named
    scored = of_effects([CoggingTorque(0.05, 8.0)], AXIS, diagnosis)
    assert [(one.quantity, one.true, one.inside(0.95)) for one in scored] == [("amplitude", 0.05, True)] * named


def test_a_name_that_no_such_recording_tells_from_it_is_right():
    diagnosis = found("explained", "torque_ripple", ambiguous=("cogging_torque",))
    assert fate(diagnosis, "cogging_torque", OWN.names)[0] == "right"


@pytest.mark.parametrize("least", [0.2, 3.3, 20.0])
def test_the_least_that_is_named_is_closed_in_on(least):
    def trial(own, name, strength, seed):
        return replace(CASE, strength=strength, fate="right" if strength >= least else "flagged")

    cases = tried(OWN, (), 1, "cogging_torque", trial)
    assert len(cases) == 5
    named = Injections(OWN, cases, True, (), {}).least["cogging_torque"]
    assert least <= named.strength <= 1.19 * least


def test_an_effect_that_is_never_named_has_no_least():
    cases = (replace(CASE, fate="missed"), replace(CASE, strength=5.0, fate="flagged"))
    assert Injections(OWN, cases, True, (), {}).least == {"cogging_torque": None}


def test_a_recording_that_leaves_inertia_open_takes_no_effects():
    left_open = SimpleNamespace(refused={"moment_of_inertia": "its interval contains zero"}, parameters={})
    with pytest.raises(UndeterminedError, match="moment of inertia cannot be determined: its interval contains zero"):
        axis_of(left_open, OWN.host.trace, RIG)


@pytest.fixture(scope="module")
def recording():
    """A plain axis with noise, in closed form."""
    rng, time = np.random.default_rng(2), host_of(SWING, SWING).trace.time
    position, speed, acceleration = sines(time, [(2.0, 0.9, 0.3), (0.6, 2.3, 1.9), (0.2, 5.1, 0.7)])
    torque = AXIS.inertia * acceleration + AXIS.viscous * speed + AXIS.coulomb * np.sign(speed)
    noise = rng.normal(size=(2, time.size))
    return host_of(position + 2e-5 * noise[0], torque + 4e-3 * noise[1]).trace


def test_a_recording_tells_its_axis_and_what_it_leaves(recording):
    itself = own(recording, RIG)
    assert itself.names == ()
    assert itself.host.axis.inertia == pytest.approx(AXIS.inertia, rel=0.01)
    assert itself.host.axis.coulomb == pytest.approx(AXIS.coulomb, rel=0.05)
    assert itself.host.load is None
    assert itself.unit == "N*m"
    assert 0.0 < itself.left < 4e-3  # what its filter leaves of the noise


def test_effects_are_put_in_named_and_reported_beside_the_truth(recording):
    done = []
    result = inject(recording, RIG, ["cogging_torque", "velocity_filter_lag"], [20.0], 1, 1, done.append)
    (case,) = result.cases
    assert (case.effect, case.fate, case.quantity, case.unit) == ("cogging_torque", "right", "amplitude", "N*m")
    assert case.torque == pytest.approx(20.0 * result.own.left, rel=0.15)
    (size,) = [one for one in case.scored if one.quantity == "amplitude"]
    assert size.true == case.size
    assert size.inside(0.95)
    assert result.unable == ("velocity_filter_lag",)  # no speed is recorded
    assert not result.sought
    assert done[-1] == 1.0


def test_a_name_that_cannot_be_put_in_is_refused(recording):
    with pytest.raises(InputError, match="--effect: found 'coging_torque', did you mean 'cogging_torque'"):
        inject(recording, RIG, ["coging_torque"])


def test_what_a_simulated_recording_holds_besides_is_no_false_name():
    named = found("explained", "unbalance", "cogging_torque", "backlash")
    assert fate(named, "cogging_torque", (*OWN.names, "backlash"))[0] == "right"
    assert fate(named, "cogging_torque", OWN.names)[0] == "part"
