"""One `bench.Effects` for all joints of a robot, on every engine: each moves as it does alone, and as on the CPU.

Engines that are not installed are skipped: `pip install mujoco-warp mujoco-mjx torch`, then `pytest -m slow -s -n 0
tests/export/test_engines.py` (minutes for the first time, as kernels are compiled).
"""

from dataclasses import replace

import array_api_strict
import mujoco
import numpy as np
import pytest
from mujoco.batch import Batch

import bench
from bench.errors import InputError
from bench.export.mjcf import onto
from bench.files import write_text
from bench.plant.model_file import joints_toml
from tests.docs.pages import PAGES, examples, run_commands
from tests.effects.axes import VALUES, WINDING
from tests.export.arms import stored
from tests.export.two_links import MJCF

#: Two joints that have nothing to do with each other.
APART = """<mujoco><option timestep="0.00025" gravity="0 0 0"/><worldbody>
  <body><joint name="first" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="1e-3 1e-3 1e-3"/></body>
  <body><joint name="second" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="0.3 0.3 0.3"/></body>
  </worldbody></mujoco>"""


def of(*names, **mounting):
    return stored(*((name, VALUES[name]) for name in names), **mounting)


FIRST = of("stribeck_friction", "torque_ripple", "position_dependent_inertia", "current_loop_lag")
SECOND = of(
    "load_dependent_friction", "friction_warmup", "direction_dependent_friction", "voltage_limit", gear_ratio=12.0
)
#: Of the arm; what is native of it rides along.
ARM = {
    "shoulder": of("stribeck_friction", "position_dependent_friction", "current_loop_lag", gear_ratio=20.0),
    "elbow": of("load_dependent_friction", "cogging_torque", "torque_ripple", "torque_constant_drift", gear_ratio=12.0),
}
STEPS = 400
#: Height of the shoulder above the floor, less than the arm is long - m.
LOW = 0.45


def robot(xml, models):
    spec = mujoco.MjSpec.from_string(xml)
    for name, model in models.items():
        onto(spec, name, model)
    return spec.compile()


def pushed(model, data, step, sizes=(0.6, 8.0), count=STEPS):
    """Velocities - (count, nv) - under swinging torques of the two motors."""
    found = np.empty((count, model.nv))
    control = [model.actuator_ctrladr[model.actuator(f"{model.joint(k).name} motor").id] for k in range(2)]
    for k in range(count):
        data.ctrl[control] = sizes * np.sin([50.0 * data.time, 23.0 * data.time])
        step(model, data)
        found[k] = data.qvel
    return found


#: A limit of voltage asks for the winding.
MODELS = {"first": FIRST, "second": replace(SECOND, model=replace(SECOND.model, winding=WINDING))}


def swung(effects=None):
    """Velocities of the two joints that stand apart, with effects stepped or without."""
    simulation = robot(APART, MODELS)
    return pushed(simulation, mujoco.MjData(simulation), mujoco.mj_step if effects is None else effects.step)


def test_each_of_several_joints_moves_as_it_does_alone(tmp_path):
    write_text(tmp_path / "effects.toml", joints_toml(MODELS))
    together, without = swung(bench.Effects(tmp_path / "effects.toml")), swung()
    for k, (name, model) in enumerate(MODELS.items()):
        alone = swung(bench.Effects(model, name))
        np.testing.assert_allclose(together[:, k], alone[:, k], rtol=1e-12, atol=1e-12)
        assert np.abs(without[:, k] - alone[:, k]).max() > 0.01 * np.abs(alone[:, k]).max()


def test_as_a_callback_all_joints_act_and_a_second_callback_is_refused():
    stepped, effects, simulation = swung(bench.Effects(MODELS)), bench.Effects(MODELS), robot(APART, MODELS)
    try:
        effects.install()
        with pytest.raises(InputError, match=r"one bench\.Effects with the models of all joints"):
            bench.Effects(FIRST, "first").install()
        called = pushed(simulation, mujoco.MjData(simulation), mujoco.mj_step)
    finally:
        mujoco.set_mjcb_control(None)
    # inertia that varies acts a step later in a callback
    assert np.abs(called - stepped).max(axis=0) == pytest.approx(0.0, abs=2e-3 * np.abs(stepped).max())


def test_copies_with_joints_of_their_own_move_as_each_alone_and_one_that_is_reset_begins_anew():
    """Not all copies have the same effects."""
    own = [MODELS, {**MODELS, "first": of("torque_ripple")}, {"first": FIRST, "second": of(gear_ratio=12.0)}]
    batch = Batch(robot(APART, MODELS), len(own))
    copies, ends = bench.Effects(MODELS).on(batch, own), []
    for _ in range(2):
        for k in range(STEPS):
            batch.ctrl[:] = [0.6 * np.sin(50.0 * k * 0.00025), 8.0 * np.sin(23.0 * k * 0.00025)]
            copies.step()
        ends.append(batch.qvel.copy())
        batch.reset([1])
    for k, models in enumerate(own):
        np.testing.assert_allclose(ends[0][k], swung(bench.Effects(models))[-1], rtol=1e-9)
    np.testing.assert_array_equal(ends[1][1], ends[0][1])
    assert ends[1][0, 0] != ends[0][0, 0]


def along(effects, as_array):
    """Torques, friction and inertia over steps of a motion that is given - (STEPS, 3, worlds, joints)."""
    rng = np.random.default_rng(5)
    offset = rng.normal(size=(7, 2))
    found, memory = [], None
    for k in range(60):
        state = [np.sin(30.0 * 5e-4 * k + offset), 30.0 * np.cos(30.0 * 5e-4 * k + offset), 3.0 * np.cos(k + offset)]
        position, velocity, torque = (as_array(values) for values in state)
        memory = effects.start(velocity) if memory is None else memory
        memory = effects.again(memory, as_array(np.full((7, 1), k == 30)), velocity)
        acts = effects.act(memory, as_array(np.full((7, 1), 5e-4 * k)), position, velocity, torque)
        memory = acts.memory
        found.append([np.asarray(each) for each in (acts.torque, acts.friction, acts.inertia)])
    return np.array(found)


def test_as_a_function_it_is_the_same_in_any_array_library():
    effects = bench.Effects(MODELS)
    expected = along(effects.on_arrays(np.zeros(1), 5e-4), np.asarray)
    found = along(effects.on_arrays(array_api_strict.zeros(1), 5e-4), array_api_strict.asarray)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)
    assert np.all(np.ptp(expected, axis=0) > 0.0, axis=1).tolist() == [[True, True], [True, True], [True, False]]


def test_tensors_get_what_arrays_get():
    """Of torch, in single precision, as an actuator of mjlab has them: (worlds, joints)."""
    torch = pytest.importorskip("torch", reason="torch is not installed")
    effects = bench.Effects(MODELS)
    expected = along(effects.on_arrays(np.zeros(1), 5e-4), np.asarray)
    made = effects.on_arrays(torch.zeros(1, dtype=torch.float32), 5e-4)
    found = along(
        made, lambda values: torch.asarray(values, dtype=torch.bool if values.dtype == bool else torch.float32)
    )
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-4)


SIZES = np.linspace(0.3, 1.0, 8)


def on_the_cpu(models, xml=MJCF):
    """Velocities of eight runs under torques of other sizes - (STEPS, 8, nv)."""
    runs = []
    for size in SIZES:
        simulation = robot(xml, models)
        effects = bench.Effects(models)
        runs.append(pushed(simulation, mujoco.MjData(simulation), effects.step, size * np.array([40.0, 12.0])))
    return np.stack(runs, axis=1)


def controls(model, k, time):
    """Of step k for the eight sizes - (8, nu)."""
    made = np.zeros((SIZES.size, model.nu))
    for joint, (size, pace) in enumerate(((40.0, 50.0), (12.0, 23.0))):
        made[:, model.actuator(f"{model.joint(joint).name} motor").id] = SIZES * size * np.sin(pace * k * time)
    return made


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("worlds", [1, 100, 4096])
def test_worlds_of_mujoco_warp_move_as_on_the_cpu(worlds):
    mjw = pytest.importorskip("mujoco_warp", reason="mujoco_warp is not installed")
    expected, simulation = on_the_cpu(ARM), robot(MJCF, ARM)
    data = mujoco.MjData(simulation)
    model, state = mjw.put_model(simulation), mjw.put_data(simulation, data, nworld=worlds)
    simulations = bench.Effects(ARM).on_warp(simulation, model, state)
    group = np.arange(worlds) % SIZES.size
    off = 0.0
    for k in range(STEPS):
        state.ctrl.assign(controls(simulation, k, simulation.opt.timestep)[group].astype(np.float32))
        simulations.step()
        off = max(off, float(np.abs(state.qvel.numpy() - expected[k][group]).max()))
    relative = off / np.abs(expected).max()
    print(f"\n{worlds} worlds: {relative:.1e} of the CPU's")
    assert relative < 1e-3


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_worlds_of_mjx_move_as_on_the_cpu():
    """Without cogging: MJX has no DC motor but on warp."""
    jax = pytest.importorskip("jax", reason="jax is not installed")
    mjx = pytest.importorskip("mujoco.mjx", reason="mujoco-mjx is not installed")
    models = {**ARM, "elbow": of("load_dependent_friction", "torque_ripple", "torque_constant_drift", gear_ratio=12.0)}
    expected, simulation = on_the_cpu(models), robot(MJCF, models)
    model = mjx.put_model(simulation)
    effects = bench.Effects(models).on_mjx(simulation, model)

    def step(carried, control):
        data, memory = effects.step(model, carried[0].replace(ctrl=control), carried[1])
        return (data, memory), data.qvel

    @jax.jit
    @jax.vmap
    def moved(inputs):
        data = mjx.put_data(simulation, mujoco.MjData(simulation))
        return jax.lax.scan(step, (data, effects.start(data)), inputs)[1]

    inputs = np.stack([controls(simulation, k, simulation.opt.timestep) for k in range(STEPS)], axis=1)
    found = np.swapaxes(np.asarray(moved(jax.numpy.asarray(inputs))), 0, 1)
    relative = np.abs(found - expected).max() / np.abs(expected).max()
    print(f"\nMJX: {relative:.1e} of the CPU's trajectory")
    assert relative < 1e-3


#: The arm over a floor that it hits, in worlds of other poses, at a step and with a frictionloss that robots have.
IN_CONTACT = (
    MJCF.replace('timestep="0.0005"', 'timestep="0.002"')
    .replace("<worldbody>", f'<worldbody><geom type="plane" size="3 3 0.1" pos="0 0 -{LOW}"/>')
    .replace("</body></body>", '<geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.03" mass="0"/></body></body>')
)
FRICTION = {"shoulder": of("stribeck_friction", gear_ratio=20.0), "elbow": of("quadratic_drag", gear_ratio=12.0)}
WORLDS = 64


def poses(model):
    """From which the arm falls onto the floor - (WORLDS, nq)."""
    return np.random.default_rng(0).uniform(-2.0, 2.0, (WORLDS, model.nq))


def hits(model):
    """In how many worlds the arm touches the floor on the CPU, which never diverges."""
    found = 0
    for pose in poses(model):
        data = mujoco.MjData(model)
        data.qpos[:] = pose
        touched = False
        for _ in range(STEPS):
            mujoco.mj_step(model, data)
            touched = touched or data.ncon > 0
        assert np.isfinite(data.qpos).all()
        found += touched
    return found


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("engine", ["mujoco_warp", "mjx"])
def test_an_export_in_contact_stays_finite_in_single_precision(engine):
    """Dry friction sticks by an impedance close to one, which a solver in single precision has to bear."""
    simulation = robot(IN_CONTACT, FRICTION)
    assert hits(simulation) > WORLDS // 2
    if engine == "mujoco_warp":
        mjw = pytest.importorskip("mujoco_warp", reason="mujoco_warp is not installed")
        model = mjw.put_model(simulation)
        state = mjw.put_data(simulation, mujoco.MjData(simulation), nworld=WORLDS, nconmax=20, njmax=100)
        state.qpos.assign(poses(simulation).astype(np.float32))
        for _ in range(STEPS):
            mjw.step(model, state)
        ends = state.qpos.numpy()
    else:
        jax = pytest.importorskip("jax", reason="jax is not installed")
        mjx = pytest.importorskip("mujoco.mjx", reason="mujoco-mjx is not installed")
        model, data = mjx.put_model(simulation), mjx.put_data(simulation, mujoco.MjData(simulation))

        @jax.jit
        @jax.vmap
        def moved(pose):
            start = data.replace(qpos=pose)
            return jax.lax.fori_loop(0, STEPS, lambda _, now: mjx.step(model, now), start).qpos

        ends = np.asarray(moved(jax.numpy.asarray(poses(simulation))))
    assert np.isfinite(ends).all()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """What the page supposes: an arm with models put onto it, without cogging, which MJX refuses."""
    models = {**ARM, "elbow": of("load_dependent_friction", "torque_ripple", gear_ratio=12.0)}
    spec = mujoco.MjSpec.from_string(MJCF)
    for name, model in models.items():
        onto(spec, name, model)
    spec.compile()
    (tmp_path / "robot_id.xml").write_text(spec.to_xml())
    write_text(tmp_path / "effects.toml", joints_toml(models))
    monkeypatch.chdir(tmp_path)


def test_the_pages_commands_run(folder):
    run_commands(PAGES["docs/engines.md"])


BLOCKS = examples("docs/engines.md")


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: block.split()[1])
def test_the_pages_code_runs(folder, block):
    pytest.importorskip(block.split()[1], reason=f"{block.split()[1]} is not installed")
    names = {}
    for each in dict.fromkeys((BLOCKS[0], block)):
        exec(compile(each, "docs/engines.md", "exec"), names)
    assert names["data"].time > 0.0
