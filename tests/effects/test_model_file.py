"""A model goes to disk and comes back as it was; what is native in it opens in MuJoCo alone."""

import tomllib

import mujoco
import numpy as np
import pytest
import tomli_w
from hypothesis import example, given
from hypothesis import strategies as st

from bench.axis_kind import LINEAR
from bench.effects.present import Present
from bench.errors import InputError
from bench.files import write_text
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.model_file import (
    LOADED,
    TIMESTEP,
    Mounting,
    StoredModel,
    joints_toml,
    load_joints,
    load_model,
    model_toml,
    model_xml,
    read_table,
    tables_toml,
)
from bench.plant.tracking import SoftTracking, track
from bench.trace.trace import Trace
from tests.effects.axes import AXIS, PERIOD, VALUES, model
from tests.plant.open_loop import open_loop

#: All but the second coupling of motor and load.
EVERYTHING = [name for name in VALUES if name != "backlash"]


def written(folder, stored):
    path = folder / "model.toml"
    write_text(path, model_toml(stored))
    return path


def test_everything_comes_back(tmp_path):
    stored = StoredModel('the "axis" \\ of\tall', model(*EVERYTHING), 1.27e-5)
    toml = written(tmp_path, stored)
    assert load_model(toml) == stored


def test_linear_axis_without_winding_comes_back(tmp_path):
    effects = (Present.of("cogging_torque", {"amplitude": 1.0, "harmonic": 2513.0}),)
    parameters = AxisParameters(95.1, 203.5, 20.4, -3.2, 0.0, kind=LINEAR)
    stored = StoredModel("slide", AxisModel(parameters, effects))
    toml = written(tmp_path, stored)
    assert load_model(toml) == stored
    text = toml.read_text(encoding="utf-8")
    assert 'moving_mass = "95.1 kg"' in text
    assert 'amplitude = "1.0 N"' in text
    assert 'phase = "0.0 rad"' in text


def test_the_joints_of_a_robot_come_back_by_their_names(tmp_path):
    slide = StoredModel("slide", AxisModel(AxisParameters(95.1, 203.5, 20.4, -3.2, 0.0, kind=LINEAR)))
    joints = {"arm/elbow joint": StoredModel("elbow", model(*EVERYTHING), 1.27e-5), "slide": slide}
    path = tmp_path / "effects.toml"
    write_text(path, joints_toml(joints))
    assert load_joints(path) == joints


@given(st.text(st.characters(exclude_categories=["Cs"])))
@example("cr\rlf\ncrlf\r\ntab\t")
@example("\x00\x01\x1f\x7f\x85\u2028\ufeff")
@example("\"\"\"quotes'''and \\ backslashes\\")
@example("] = [[effects]]\nname = 1 # no comment")
def test_any_name_comes_back(tmp_path_factory, name):
    stored = StoredModel(name, model("cogging_torque"), -3.1e-4)
    path = tmp_path_factory.mktemp("named") / "model.toml"
    write_text(path, model_toml(stored, {"balance": {"recording": name, name or "empty": [{"shape": [0.1, 1e-300]}]}}))
    assert load_model(path) == stored
    beside = read_table(path)["balance"]
    assert beside == {"recording": name, name or "empty": [{"shape": [0.1, 1e-300]}]}


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_every_number_comes_back_to_the_last_bit(value):
    text = model_toml(StoredModel("axis", model(), value), {"beside": {"numbers": [value, -value]}})
    table = tomllib.loads(text)
    assert table["beside"]["numbers"] == [value, -value]
    assert float(table["misalignment"].removesuffix(" s")) == value


def test_tables_stand_alone_where_there_is_no_model(tmp_path):
    path = tmp_path / "model.toml"
    write_text(path, tables_toml(LINEAR, {"balance": {"mains": [50.0]}}))
    assert read_table(path) == {"schema": "bench.model/1", "kind": "linear", "balance": {"mains": [50.0]}}
    with pytest.raises(InputError, match="parameters: missing"):
        load_model(path)


@pytest.mark.parametrize("names", [("elastic_coupling", "cogging_torque", "quadratic_drag"), ("presliding_friction",)])
def test_xml_moves_as_the_model(names):
    """MuJoCo writes numbers with six digits or more."""
    native = model(*names, "torsion_spring", "unbalance", "torque_offset")
    xml = model_xml(StoredModel("axis", native))
    torque = np.sin(np.arange(4000) / 200.0)
    mujoco.MjModel.from_xml_string(xml)
    specs = native.spec(TIMESTEP), mujoco.MjSpec.from_string(xml)
    motions = [open_loop(spec, torque).velocity for spec in specs]
    np.testing.assert_allclose(motions[1], motions[0], atol=1e-3 * np.abs(motions[0]).max())


def test_xml_names_what_it_lacks():
    xml = model_xml(StoredModel("axis", model("stribeck_friction", "cogging_torque", "velocity_filter_lag")))
    assert f"<!-- model.xml lacks stribeck_friction. To simulate them too: {LOADED} instead of" in xml
    assert "<!-- model.xml lacks velocity_filter_lag, which is in what sensors report" in xml
    assert "lacks" not in model_xml(StoredModel("axis", model("cogging_torque")))
    geared = StoredModel("axis", model("torque_ripple"), mounting=Mounting(7.0))
    assert "put the model onto a joint with bench export" in model_xml(geared)


BAD = [
    ('schema = "bench.model/1"', 'schema = "bench.model/2"', "bench.model/1"),
    ('kind = "rotary"', 'kind = "round"', "rotary, linear"),
    ("moment_of_inertia =", "moment_of_inertai =", "did you mean 'moment_of_inertia'"),
    ('"0.0012 kg*m**2"', '"0.0012 kg"', "dimension of kg"),
    ('name = "cogging_torque"', 'name = "coging_torque"', "did you mean 'cogging_torque'"),
    ("amplitude =", "amplitud =", "did you mean 'amplitude'"),
    ('"0.08 N*m"', '"-0.08 N*m"', "0 to inf"),
    ("harmonic = 6.0, ", "", "harmonic missing"),
    ("[parameters]", "[parameters", "not TOML"),
    ("effects = [", "effects = [1, ", "effects: found 1"),
    ("effects = [", "effects = 1\nunused = [", "found 1; allowed: a list"),
    ('"1e-05 s"', "nan", "finite"),
    ('"0.0012 kg*m**2"', '"0 kg*m**2"', "moment_of_inertia"),
    ('"0.0012 kg*m**2"', '"1e300 kg*m**2"', "no servo axis has"),
    ('"0.0012 kg*m**2"', '"2e9 kg*m**2"', "allowed: above zero to 1e+09 kg*m**2"),
    ('"0.08 N*m"', '"1e200 N*m"', "no servo axis has"),
    ('"0.0004 kg*m**2"', '"1 kg*m**2"', "allowed: at most as much in the motor"),
]
BAD_JOINTS = [
    ("bench.effects/1", "bench.model/1", "schema: found 'bench.model/1'; allowed: 'bench.effects/1'"),
    ("[joints.elbow.parameters]", "[joints.elbow.parameter]", "joints.elbow: parameters: missing"),
    ("[joints.elbow]", "[joint.elbow]", "joints.elbow"),
    ("[joints.elbow]", "[joints]\nknee = 3\n[joints.elbow]", "joints: found"),
]


@pytest.mark.parametrize(
    ("load", "old", "new", "says"), [*((load_model, *row) for row in BAD), *((load_joints, *row) for row in BAD_JOINTS)]
)
def test_bad_files_are_refused_in_one_line(tmp_path, load, old, new, says):
    stored, path = StoredModel("axis", model("cogging_torque"), 1e-5), tmp_path / "model.toml"
    text = model_toml(stored) if load is load_model else joints_toml({"elbow": stored})
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError) as error:
        load(path)
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_no_such_file(tmp_path):
    with pytest.raises(InputError, match=r"give the path of a model\.toml"):
        load_model(tmp_path / "none.toml")


def test_a_stored_model_runs_along_a_recording(truths, tmp_path):
    signals = truths["cogging_torque",]
    kept = {"velocity": signals["velocity"][::8], "current": signals["current"][::8]}
    trace = Trace(PERIOD * 8 * np.arange(kept["velocity"].size), kept, {"velocity": "rad/s", "current": "A"}, "axis")
    toml = written(tmp_path, StoredModel("axis", model("cogging_torque"), -PERIOD / 2.0))
    stored = load_model(toml)
    effort = AXIS.torque_constant * trace["current"]
    simulated = track(SoftTracking(stored.model, trace, effort, stored.misalignment)).velocity
    assert np.sqrt(np.mean((trace["velocity"] - simulated) ** 2)) < 0.03


def with_balance(tmp_path, text, coefficients, said=None):
    path = tmp_path / "model.toml"
    flag = {} if said is None else {"same_parameters": said}
    table = {**tomllib.loads(text), "torque_balance": {**flag, "coefficients": coefficients}}
    path.write_text(tomli_w.dumps(table), encoding="utf-8")
    return path


def test_a_file_says_whether_its_parameters_are_the_coefficients():
    stored = StoredModel("axis", model("cogging_torque"), 1e-5)
    values = [value for value, _ in list(stored.model.parameters.values.values())[:3]]
    for coefficients, same in ((values, True), ([1.01 * values[0], *values[1:]], False)):
        table = tomllib.loads(model_toml(stored, {"torque_balance": {"coefficients": [*coefficients, 1e-5]}}))
        assert table["torque_balance"]["same_parameters"] is same


@pytest.mark.parametrize("place", range(3))
@pytest.mark.parametrize(
    ("said", "factor", "refused"), [(True, 1.001, True), (None, 30.0, True), (None, 1.2, False), (False, 1.2, False)]
)
def test_parameters_that_contradict_the_torque_balance_are_refused(tmp_path, place, said, factor, refused):
    stored = StoredModel("axis", model("cogging_torque"))
    coefficients = [value for value, _ in list(stored.model.parameters.values.values())[:3]]
    coefficients[place] *= factor
    coefficients.append(0.0)
    path = with_balance(tmp_path, model_toml(stored), coefficients, said)
    if refused:
        with pytest.raises(InputError, match="among the coefficients of torque_balance; allowed: one value in both"):
            load_model(path)
    else:
        assert load_model(path) == stored
