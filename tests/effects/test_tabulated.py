"""Tables of an unknown effect: what they are between and beyond their nodes, and where a model with them goes."""

import array_api_strict as strict
import mujoco
import numpy as np
import pytest

import bench
from bench.effects.catalogue import catalogue
from bench.effects.present import Present
from bench.effects.signals import AxisState
from bench.effects.tabulated import NAMES, NODES, TABLES
from bench.errors import InputError
from bench.export.feedforward import feedforward
from bench.export.mjcf import single_joint
from bench.export.simulators import TARGETS, simulator_file
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.model_file import StoredModel, load_model, model_toml, model_xml

PARAMETERS = AxisParameters(2e-3, 0.0, 0.05, 0.0, 5e-4)
RNG = np.random.default_rng(5)


def table(name, torque, low=-2.0, high=3.0, turns=0.0):
    return Present.of(name, {"low": low, "high": high, "turns": turns} | dict(zip(NAMES, torque.tolist(), strict=True)))


def state(x):
    return AxisState(0.0, x, x, x)


@pytest.mark.parametrize("name", TABLES)
def test_a_table_is_linear_between_its_nodes_and_constant_beyond_them(name):
    low, high = (-2.0, 3.0) if name.endswith("position") else (0.5, 3.0)
    torque = RNG.normal(size=NODES)
    values = {key: np.float64(value) for key, value in table(name, torque, low, high).values}
    x = np.linspace(-5.0, 5.0, 301)
    expected = np.interp(x if name.endswith("position") else np.abs(x), np.linspace(low, high, NODES), torque)
    np.testing.assert_allclose(TABLES[name].level(values, state(x)), expected, atol=1e-12)
    alone = [TABLES[name].level(values, state(one)) for one in x]
    np.testing.assert_allclose(alone, expected, atol=1e-12)
    made = {key: strict.asarray(np.full(x.size, value)) for key, value in values.items()}
    there = TABLES[name].level(made, state(strict.asarray(x)))
    np.testing.assert_allclose(np.asarray(there), expected, atol=1e-12)


def test_over_a_whole_turn_it_repeats_itself():
    torque = np.sin(np.linspace(0.0, 2.0 * np.pi, NODES))
    values = {key: np.float64(value) for key, value in table(next(iter(TABLES)), torque, 0.0, 2.0 * np.pi, 1.0).values}
    x = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False)
    here, there = (TABLES[next(iter(TABLES))].level(values, state(x + turn)) for turn in (0.0, -6.0 * np.pi))
    np.testing.assert_allclose(there, here, atol=1e-12)


def test_no_table_can_be_a_name():
    assert not set(TABLES) & set(catalogue())


@pytest.mark.parametrize("name", TABLES)
def test_a_table_of_zeros_is_absent(name):
    assert AxisModel(PARAMETERS, (table(name, np.zeros(NODES)),)) == AxisModel(PARAMETERS)


def with_all():
    torques = np.random.default_rng(7).normal(scale=0.01, size=(len(TABLES), NODES))
    tables = [table(name, torque, 0.0, 2.0) for name, torque in zip(TABLES, torques, strict=True)]
    return StoredModel("axis", AxisModel(PARAMETERS, tuple(tables)))


def test_a_model_file_holds_tables_with_units(tmp_path):
    path = tmp_path / "model.toml"
    path.write_text(model_toml(with_all()), encoding="utf-8")
    assert load_model(path) == with_all()
    text = path.read_text(encoding="utf-8")
    assert 'node_00 = "' in text
    assert 'high = "2.0 rad/s"' in text


def test_a_table_with_an_unknown_node_is_refused(tmp_path):
    path = tmp_path / "model.toml"
    path.write_text(model_toml(with_all()).replace("node_47", "node_48"), encoding="utf-8")
    with pytest.raises(InputError, match="node_48"):
        load_model(path)


def released(effects, start):
    """Position and speed of the axis with effects, released at a position - (n,) each - at steps of 0.1 ms."""
    stored = StoredModel("axis", AxisModel(PARAMETERS, tuple(effects)))
    spec = stored.model.spec(1e-4)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[0] = start
    stepped, found = bench.Effects(stored), []
    for _ in range(5000):
        stepped.step(model, data)
        found.append((data.qpos[0], data.qvel[0]))
    return np.array(found).T


def test_a_simulation_steps_a_torque_over_position_against_its_closed_form():
    """A spring of a table: a half cycle with dry friction loses 2*K_0/c of amplitude."""
    stiffness = 0.8
    position, _ = released([table(next(iter(TABLES)), stiffness * np.linspace(-2.0, 3.0, NODES))], 1.0)
    turning = position[: round(np.pi * np.sqrt(PARAMETERS.inertia / stiffness) / 1e-4) + 20].min()
    assert turning == pytest.approx(-(1.0 - 2.0 * PARAMETERS.coulomb_friction / stiffness), abs=1e-3)


def test_friction_of_a_table_holds_and_never_drives():
    spring = table(next(iter(TABLES)), 0.1 * np.linspace(-2.0, 3.0, NODES))
    held = table("unknown_friction_over_position", np.full(NODES, 0.1))
    slippery = table("unknown_friction_over_position", np.full(NODES, -1.0))
    assert np.ptp(released([spring, held], 1.0)[0]) < 1e-4
    position, speed = released([spring, slippery], 1.0)
    energy = 0.5 * PARAMETERS.inertia * speed**2 + 0.05 * position**2
    assert energy.max() < 0.05 * (1.0 + 1e-3)


def test_every_export_carries_a_table_or_says_that_it_does_not():
    stored = with_all()
    texts = [model_xml(stored), "\n".join(single_joint(stored, "joint")[1].lines)]
    texts += ["\n".join(simulator_file(to, {"joint": stored}, "xl330" if to == "bam" else None)[1]) for to in TARGETS]
    for text in texts:
        assert all(name in text for name in TABLES)


def test_a_feedforward_has_the_torque_and_the_friction_of_a_table():
    shape = np.cos(np.linspace(0.0, 2.0 * np.pi, NODES))
    tables = table(next(iter(TABLES)), 0.02 * shape, 0.0, 2.0 * np.pi, 1.0)
    risen = table("unknown_friction_over_speed", np.full(NODES, 0.03), 0.0, 10.0)
    found = feedforward(AxisModel(PARAMETERS, (tables, risen)), 10.0, (0.0, 6.0))
    assert found.left == ()
    assert found.friction(np.array([5.0]))[0] == pytest.approx(0.08, abs=2e-3)
    np.testing.assert_allclose(found.cogging(np.array([0.0, np.pi])), [0.02, -0.02], atol=1e-3)
