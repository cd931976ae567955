"""What every effect of the catalogue keeps to, whatever it is."""

from dataclasses import replace

import numpy as np
import pytest

from bench.arrays import rms
from bench.effects.catalogue import catalogue
from bench.effects.effect import Bristles, Columns, Coupling, Effect, Stage
from bench.effects.present import Present
from bench.effects.signals import AxisState, Signals
from bench.effects.torque import Friction, Inertia, Torque
from bench.plant.axis_model import build_spec
from bench.plant.run import run
from bench.plant.sensing import remaining
from bench.plant.stepped_effects import SteppedEffects
from tests.effects.axes import AXIS, FREE, PARAMETERS, PERIOD, VALUES, Reversals, model, moved, plant, present
from tests.plant.open_loop import open_loop

#: Those of other packages are held by their own tests.
EFFECTS = sorted(name for name, effect in catalogue().items() if type(effect).__module__.startswith("bench."))
SHORT = Reversals(0.4).references()
#: Effects that the torque balance holds as columns of raw signals.
BALANCED = [
    name for name in EFFECTS if isinstance(catalogue()[name], Columns) and not isinstance(catalogue()[name], Coupling)
]
#: What only takes energy from the motion and is none of the frictions of `tests/laws/test_energy.py`.
DISSIPATIVE = [n for n in EFFECTS if isinstance(catalogue()[n], Bristles) or n == "quadratic_drag"]


def with_null(name):
    values = {**VALUES[name], **{key: float(value) for key, value in catalogue()[name].null(model().axis).items()}}
    return Present.of(name, values)


def test_every_effect_of_the_catalogue_is_tried():
    assert sorted(VALUES) == EFFECTS


@pytest.mark.parametrize("name", EFFECTS)
def test_null_values_are_no_effect(name):
    assert replace(plant(), axis=model().with_effects([with_null(name)])).model == plant().model


@pytest.mark.parametrize("name", [n for n in EFFECTS if np.isfinite(list(dict(with_null(n).values).values())).all()])
def test_null_values_do_nothing_where_they_act(name):
    """Not only are absent effects left out: acting on null values does nothing either."""
    effect, values, axis = catalogue()[name], dict(with_null(name).values), model().axis
    if type(effect).add is not Effect.add and not isinstance(effect, Coupling):
        motions = []
        for adds in (False, True):
            spec = build_spec(PARAMETERS, PERIOD)
            if adds:
                effect.add(spec, name, values, axis)
            motions.append(open_loop(spec, 0.5 * np.sin(np.arange(4000) / 300.0), 0.1, 3.0))
        np.testing.assert_array_equal(motions[0].velocity, motions[1].velocity)
    position, velocity, effort = np.array([[0.3, -2.0], [5.0, -0.1], [1.0, -0.2]])
    at = AxisState(0.1, position, velocity, effort, load=0.3, friction=0.06, step=PERIOD)
    found = [effect.torque(values, axis, at)] if isinstance(effect, Torque) else []
    found += [effect.friction(values, axis, at)] if isinstance(effect, Friction) else []
    found += effect.inertia(values, axis, position) if isinstance(effect, Inertia) else []
    for each in found:
        np.testing.assert_array_equal(np.broadcast_to(each, 2), np.zeros(2))


def test_order_does_not_matter():
    names = [name for name in EFFECTS if name != "backlash"]
    plants = [plant(*names), plant(*names[::-1]), plant(*np.random.default_rng(1).permutation(names))]
    first, *others = (run(one, SHORT).velocity for one in plants)
    for other in others:
        np.testing.assert_array_equal(other, first)
    assert np.abs(first).max() > 10.0


@pytest.mark.parametrize("name", DISSIPATIVE)
@pytest.mark.parametrize("velocity", [40.0, -40.0])
def test_friction_only_dissipates(name, velocity):
    """Coasting, the axis never gains energy, but for what bristles store, and loses it all."""
    friction = replace(FREE, coulomb_friction=AXIS.coulomb, viscous_friction_coefficient=AXIS.viscous)
    states = moved([present(name)], 1.0, velocity=velocity, parameters=friction)
    energy = 0.5 * FREE.inertia * states.velocity**2
    stored = AXIS.coulomb**2 / (2.0 * VALUES[name]["bristle_stiffness"]) if name == "presliding_friction" else 0.0
    assert (energy <= np.minimum.accumulate(energy) + stored + 1e-9).all()
    assert energy[-1] < 0.01 * energy[0]


@pytest.mark.parametrize("name", BALANCED)
def test_columns_agree_with_the_simulation(name):
    """Motor torque less J*alpha + K_w*omega + K_0*sgn(omega) is the columns' sum, and gives the values back."""
    effect, values = catalogue()[name], dict(VALUES[name])
    if name == "presliding_friction":
        values["bristle_damping"] = 0.0
    if name == "friction_warmup":
        values["relative_amplitude"] = 0.4
    axis = model().with_effects([Present.of(name, values)])
    states = run(replace(plant(), axis=axis), Reversals(0.6).references())
    gap, columns, shape = balance(effect, values, states)
    strengths, *_ = np.linalg.lstsq(columns, gap, rcond=None)
    off = gap - columns @ strengths
    share = rms(off) / rms(gap)
    found = effect.report(strengths, shape, AXIS)
    print(f"{name}: {share:.1e} of the gap unexplained; {found} of {values}")
    assert share < 0.006
    for key, value in found.items():
        if key in values:
            scale = AXIS.coulomb / 2.0 if "difference" in key else abs(value)
            if key == "bristle_damping":  # of none, against critical damping of the bristles
                scale = 2.0 * np.sqrt(values["bristle_stiffness"] * AXIS.inertia)
            assert found[key] == pytest.approx(values[key], rel=0.01, abs=0.01 * scale)


def balance(effect: Effect, values, states):
    """The gap at the middles of steps that do not reverse, the effect's columns there, and its shape."""
    time, q, w = states.time, states.position, states.velocity
    effort = states.torque[:-1]
    middle = signals_of(time[:-1] + PERIOD / 2.0, (q[1:] + q[:-1]) / 2.0, (w[1:] + w[:-1]) / 2.0, effort)
    ends = signals_of(time, q, w, states.torque)
    given = {**values, "bristle_rate": values.get("bristle_stiffness", 0.0) / AXIS.coulomb}
    shape = [given[shape.quantity.name] for shape in effect.shapes]
    columns = [
        sum(raw if order == 0 else np.diff(late) / PERIOD for (raw, order), (late, _) in zip(here, there, strict=True))
        for here, there in zip(effect.columns(middle, shape), effect.columns(ends, shape), strict=True)
    ]
    gap = effort - AXIS.inertia * np.diff(w) / PERIOD - AXIS.viscous * middle.velocity - AXIS.coulomb * middle.sign
    clear = (np.sign(w[1:]) == np.sign(w[:-1])) & (np.abs(middle.velocity) > 0.3)
    return gap[clear], np.stack(columns, axis=1)[clear], shape


def signals_of(time, position, velocity, effort):
    sign = np.sign(velocity)
    return Signals(time, position, velocity, sign, effort, effort, sign, AXIS.peak_torque, PERIOD)


def test_axes_with_and_without_effects_are_moved_side_by_side_as_alone():
    """An effect is gathered over the axes that have it."""
    cases = [("stribeck_friction", "torque_ripple"), ("friction_warmup",), ("torque_ripple",), ()]
    axes = [model(*case) for case in cases]
    time, position, velocity, demand = 0.3, *(np.array([0.3, -1.0, 2.0, 0.1]) * size for size in (1.0, 5.0, 2.0))
    together = SteppedEffects(axes, PERIOD)
    found = together.act(together.start(velocity), time, position, velocity, demand)
    for column, axis in enumerate(axes):
        alone, state = SteppedEffects([axis], PERIOD), [one.item(column) for one in (position, velocity, demand)]
        acts = alone.act(alone.start(state[1]), time, *state)
        for name in ("reported", "motor", "torque", "friction"):
            expected = getattr(acts, name)
            expected = PARAMETERS.coulomb_friction if expected is None else expected
            assert getattr(found, name)[column] == pytest.approx(expected, rel=1e-14)


def test_every_stage_of_the_signal_chain_has_its_own_place():
    """Two of one number would be one."""
    assert len(Stage.__members__) == len([*Stage])
    assert [*Stage] == sorted(Stage)


def test_effort_that_remains_after_the_stage_follows_the_position():
    """Along a recording, too, as a held model gets it: M*(1 + A*sin(n*q + phi))."""
    position, effort = np.linspace(-3.0, 5.0, 50), np.linspace(-1.0, 2.0, 50)
    at, values = AxisState(0.0, position, 0.0 * position, effort), VALUES["torque_ripple"]
    factor = 1.0 + values["relative_amplitude"] * np.sin(values["harmonic"] * position + values["phase"])
    np.testing.assert_allclose(remaining(model("torque_ripple"), Stage.COMMUTATION, at), effort * factor, rtol=1e-12)
    np.testing.assert_array_equal(remaining(model("torque_ripple"), Stage.CURRENT_SENSOR, at), effort)
