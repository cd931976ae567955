"""Effects in a loop of one's own move a joint as the bench's own plant does, one simulation or many at once."""

from pathlib import Path
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
from mujoco.batch import Batch

import bench
from bench.effects.catalogue import catalogue
from bench.effects.effect import EncoderFault
from bench.effects.mjcf import AXIS, DRIVE
from bench.errors import InputError
from bench.export.mjcf import ArmatureShare, armature_of, onto
from bench.plant.drive import CascadeDrive, References
from bench.plant.model_file import LOADED, Mounting, StoredModel, model_toml, model_xml
from bench.plant.run import run
from tests.effects.axes import CASCADE, PARAMETERS, PERIOD, VALUES, Reversals, model, plant
from tests.export.arms import ARM, stored

MOTION = Reversals(0.25, 40.0)
TIME = PERIOD * np.arange(round(MOTION.duration / PERIOD) + 1)
REFERENCES = References(TIME, *MOTION.at(TIME))
#: What the drive sees is the drive's own matter, which here is written by hand.
ACTING = [name for name in VALUES if not isinstance(catalogue()[name], EncoderFault)]
TOGETHER = ("stribeck_friction", "friction_warmup", "torque_ripple", "presliding_friction", "current_loop_lag")


def driven(simulation, effects, joint=AXIS, actuator=DRIVE, ratio=1.0):
    """Speed of the motor - (n,) - in a loop of one's own, under the drive of the rig written around it."""
    data, half = mujoco.MjData(simulation), PERIOD / 2.0
    drive = CascadeDrive(CASCADE, REFERENCES)
    here, control = simulation.joint(joint), simulation.actuator_ctrladr[simulation.actuator(actuator).id]
    q, w = int(here.qposadr[0]), int(here.dofadr[0])
    velocity = np.empty(TIME.size)
    for k in range(TIME.size):
        velocity[k] = speed = ratio * float(data.qvel[w])
        _, data.ctrl[control] = drive.tick(k, ratio * float(data.qpos[q]) - half * speed, speed)
        effects.step(simulation, data)
    return velocity


@pytest.mark.parametrize("names", [*((name,) for name in ACTING), TOGETHER], ids="+".join)
def test_it_agrees_with_the_plant(names):
    expected = run(plant(*names), REFERENCES).velocity
    effects = bench.Effects(StoredModel("axis", plant(*names).model))
    velocity = driven(plant(*names).spec().compile(), effects)
    # the native drive is MuJoCo's, which agrees with the one written out to 3e-5 of 100 rad/s (docs/plant.md)
    np.testing.assert_allclose(velocity, expected, atol=1e-4 if plant(*names).native else 1e-9)


def test_the_line_that_model_xml_states_moves_it_as_the_plant(tmp_path, monkeypatch):
    """In a loop around the file alone; without the line it moves otherwise."""
    names = ("stribeck_friction", "torque_ripple", "position_dependent_inertia", "unbalance")
    expected, stored = run(plant(*names), REFERENCES).velocity, StoredModel("axis", model(*names))
    (tmp_path / "model.xml").write_text(model_xml(stored), encoding="utf-8")
    (tmp_path / "model.toml").write_text(model_toml(stored), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert LOADED in Path("model.xml").read_text(encoding="utf-8")
    made = dict[str, object](bench=bench)
    exec(LOADED.split(";")[0], made)
    xml = mujoco.MjModel.from_xml_path("model.xml")
    xml.opt.timestep = PERIOD
    loaded, plain = (driven(xml, stepped) for stepped in (made["effects"], SimpleNamespace(step=mujoco.mj_step)))
    # the file's numbers have six digits, and its friction is for steps twice as long
    assert np.abs(loaded - expected).max() < 1e-3 * np.abs(expected).max()
    assert np.abs(plain - expected).max() > 20.0 * np.abs(loaded - expected).max()


def test_it_agrees_on_a_joint_behind_a_gear(tmp_path):
    """From the file, on an MJCF of somebody else whose link has the load's inertia."""
    names, ratio = TOGETHER[:3], 12.0
    expected = run(plant(*names), REFERENCES).velocity
    toml = tmp_path / "model.toml"
    toml.write_text(model_toml(StoredModel("axis", model(*names), mounting=Mounting(ratio))), encoding="utf-8")
    load = (PARAMETERS.inertia - PARAMETERS.motor_inertia) * ratio**2
    xml = f"""<mujoco><option timestep="{PERIOD}"/><worldbody><body><joint name="elbow" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="1" diaginertia="{load} {load} {load}"/></body></body></worldbody></mujoco>"""
    spec = mujoco.MjSpec.from_string(xml.replace("</body></body>", "</body>"))
    effects = bench.Effects(toml, joint="elbow")
    read = effects.models["elbow"]
    onto(spec, "elbow", read, armature_of(read, ArmatureShare.MOTOR))
    velocity = driven(spec.compile(), effects, "elbow", "elbow motor", ratio)
    # damping acts at the end of a step here, in its middle in the plant
    assert np.abs(velocity - expected).max() < 1e-3 * np.abs(expected).max()


def pushed(step, control, time):
    for now in time:
        control[..., 0] = 0.5 * np.sin(40.0 * now)
        step()


def test_many_copies_move_as_each_alone():
    """Copies with models of their own: each as in a loop of its own, to the last bit."""
    values = [0.1, 0.14, 0.3]
    models = [
        stored(("stribeck_friction", {"static_friction": value, "stribeck_velocity": 5.0}), *RIPPLED)
        for value in values
    ]
    simulation = models[0].model.spec(PERIOD).compile()
    batch = Batch(simulation, len(models))
    copies = bench.Effects(models[0]).on(batch, models)
    pushed(copies.step, batch.bind("ctrl"), TIME[:800])
    alone = []
    for each in models:
        data, effects = mujoco.MjData(simulation), bench.Effects(each)
        simulation.dof_frictionloss[:] = each.model.parameters.coulomb_friction
        pushed(lambda data=data, effects=effects: effects.step(simulation, data), data.ctrl, TIME[:800])
        alone.append(data.qvel[0])
    assert np.ptp(alone) > 0.1
    np.testing.assert_array_equal(batch.bind("qvel")[:, 0], alone)


RIPPLED = (("torque_ripple", {"relative_amplitude": 0.05, "harmonic": 4.0}),)


def test_as_mujocos_callback_it_does_the_same():
    model_, ends = stored(("stribeck_friction", VALUES["stribeck_friction"]), *RIPPLED), []
    for installed in (False, True):
        simulation = model_.model.spec(PERIOD).compile()
        data, effects = mujoco.MjData(simulation), bench.Effects(model_)
        step = mujoco.mj_step if installed else effects.step
        try:
            if installed:
                effects.install()
            pushed(lambda step=step, simulation=simulation, data=data: step(simulation, data), data.ctrl, TIME[:800])
        finally:
            mujoco.set_mjcb_control(None)
        ends.append(data.qvel[0])
    assert ends[0] != 0.0
    assert ends[1] == pytest.approx(ends[0], rel=1e-6)


def test_torque_of_others_stays_and_a_reset_begins_anew():
    model_ = stored(("load_torque_event", {"torque": 0.2, "start": 0.0, "end": 0.05}))
    simulation = model_.model.spec(PERIOD).compile()
    data, effects = mujoco.MjData(simulation), bench.Effects(model_)
    for _ in range(2):
        mujoco.mj_resetData(simulation, data)
        data.qfrc_applied[0] = 0.5
        seen = []
        while data.time < 0.1:
            effects.step(simulation, data)
            seen.append(data.qfrc_applied[0])
        assert seen[10] == pytest.approx(0.3)
        assert seen[-1] == pytest.approx(0.5)


@pytest.mark.parametrize("names", [("position_dependent_inertia",), ()])
def test_a_second_run_of_a_model_begins_with_its_own_inertia(names):
    model_ = stored(*((name, VALUES[name]) for name in names))
    simulation, effects = model_.model.spec(PERIOD).compile(), bench.Effects(model_)
    ends = []
    for _ in range(2):
        data = mujoco.MjData(simulation)
        pushed(lambda data=data: effects.step(simulation, data), data.ctrl, TIME[:200])
        ends.append(data.qvel[0])
    assert ends[0] == ends[1] != 0.0
    assert data.time == pytest.approx(200 * PERIOD)


def rippling(actuator):
    """The arm with an actuator of its elbow whose torque ripples by half; its model, data and effects."""
    spec = mujoco.MjSpec.from_string(ARM.replace("</actuator>", f"{actuator}</actuator>"))
    model_ = stored(("torque_ripple", {"relative_amplitude": 0.5, "harmonic": 1.0, "phase": np.pi / 2.0}))
    onto(spec, "elbow", model_)
    simulation = spec.compile()
    return simulation, mujoco.MjData(simulation), bench.Effects(model_, "elbow")


def test_a_servo_of_ones_own_is_asked_for_its_torque():
    """A position servo's torque is not its input."""
    simulation, data, effects = rippling('<position name="servo" joint="elbow" kp="30" kv="2"/>')
    data.ctrl[simulation.actuator("servo").id] = 0.05
    for _ in range(20):
        angle = data.qpos[1]
        effects.step(simulation, data)
        force = data.actuator_force[simulation.actuator("servo").id]
        assert data.qfrc_applied[1] == pytest.approx(force * 0.5 * np.cos(angle), rel=1e-12)
    assert force > 0.1


@pytest.mark.parametrize(("control", "torque"), [(0.05, 0.6), (-0.05, -0.6), (3.0, 1.2), (-3.0, -1.2), (0.25, 1.5)])
def test_a_motors_torque_is_its_input_within_its_limits(control, torque):
    """Gain 4 and gear 3 make 12 N*m per input; inputs up to 0.1, or forces up to 0.5, behind a ratio of 1."""
    limit = 'ctrlrange="-.1 .1"' if control != 0.25 else 'forcerange="-.5 .5"'
    simulation, data, effects = rippling(f'<general name="m" joint="elbow" gear="3" gainprm="4" {limit}/>')
    data.ctrl[simulation.actuator("m").id] = control
    effects.step(simulation, data)
    assert data.qfrc_applied[1] == pytest.approx(0.5 * torque)


def test_what_cannot_be_stepped_is_reported():
    simulation = mujoco.MjModel.from_xml_string(ARM)
    stribeck = stored(("stribeck_friction", VALUES["stribeck_friction"]))
    effects = bench.Effects(stribeck, "ellbow")
    with pytest.raises(InputError, match="found none of that name; allowed: shoulder, elbow, slide"):
        effects.step(simulation, mujoco.MjData(simulation))
    simulation.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    with pytest.raises(InputError, match="RK4"):
        bench.Effects(stored(), "elbow").step(simulation, mujoco.MjData(simulation))
    simulation.opt.integrator = 0
    with pytest.raises(InputError, match="one for each of the 3 copies"):
        bench.Effects(stored(), "elbow").on(Batch(simulation, 3), [stored()])
