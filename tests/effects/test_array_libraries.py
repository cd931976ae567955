"""What effects do in a step is written for any array library of the standard, whose strictest is asked here.

`array_api_strict` has nothing that the standard does not promise: no NumPy function takes its arrays, no types mix.
"""

from dataclasses import fields, replace

import array_api_strict as strict
import numpy as np
import pytest

from bench.arrays import NUMBERS, namespace
from bench.effects.catalogue import catalogue
from bench.effects.effect import DriveLimit, EncoderFault, Lag
from bench.effects.signals import Axis, AxisState, Winding
from bench.effects.torque import Friction, Inertia, Torque
from bench.plant.axis_model import AxisParameters
from tests.effects.axes import PERIOD, VALUES, model

COUNT = 40
rng = np.random.default_rng(3)
STATE = AxisState(*(scale * rng.normal(size=COUNT) for scale in (1.0, 5.0, 20.0, 2.0, 0.1, 0.3, 0.06)), step=PERIOD)
DEMAND, BEFORE = rng.normal(size=(2, COUNT))


def of_axes(value):
    return np.full(COUNT, float(value))


#: Every method of a step: the type that asks for it, and what it is given beside values and axis.
STEPS = {
    Torque: lambda e, v, a, at, _: e.torque(v, a, at),
    Friction: lambda e, v, a, at, _: e.friction(v, a, at),
    Inertia: lambda e, v, a, at, _: e.inertia(v, a, at.position),
    DriveLimit: lambda e, v, a, at, drive: e.flowing(v, a, at.velocity, *drive, PERIOD),
    Lag: lambda e, v, a, at, drive: e.stepped(v, *drive, PERIOD),
    EncoderFault: lambda e, v, a, at, _: e.measured(v, at.position, at.velocity),
}
CASES = [
    (name, kind)
    for name, effect in catalogue().items()
    for kind in STEPS
    if isinstance(effect, kind) and not (kind is Torque and type(effect).torque is Friction.torque)
]


def everywhere(value, made):
    """A structure of numbers or arrays with each made another."""
    if isinstance(value, AxisState):
        return AxisState(*(made(each) if np.ndim(each) else each for each in value))
    if isinstance(value, (Axis, Winding)):
        return replace(value, **{each.name: everywhere(getattr(value, each.name), made) for each in fields(value)})
    return made(value)


#: The axis of the tests, once for each of many.
AXES = everywhere(model().axis, of_axes)


@pytest.mark.parametrize(("name", "kind"), CASES, ids=lambda value: getattr(value, "__name__", value))
def test_a_step_is_the_same_on_arrays_of_the_standard(name, kind):
    values = {key: of_axes(value) for key, value in VALUES[name].items()}
    given = values, AXES, STATE, (DEMAND, BEFORE)
    expected = STEPS[kind](catalogue()[name], *given)
    others = {key: strict.asarray(value) for key, value in values.items()}
    drive = tuple(map(strict.asarray, (DEMAND, BEFORE)))
    found = STEPS[kind](catalogue()[name], others, *(everywhere(each, strict.asarray) for each in given[1:3]), drive)
    for one, other in zip(np.atleast_2d(expected), found if isinstance(found, tuple) else (found,), strict=True):
        assert namespace(other) is strict
        np.testing.assert_allclose(np.asarray(other), one, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("kind", STEPS, ids=lambda kind: kind.__name__)
def test_every_method_of_a_step_is_asked(kind):
    assert any(asked is kind for _, asked in CASES)


def test_what_is_no_array_has_no_functions():
    assert namespace(np.float64(1.0)) is NUMBERS
    assert namespace(1.0) is NUMBERS
    assert namespace(np.ones(2)) is np
    with pytest.raises(TypeError):
        namespace(AxisParameters)
