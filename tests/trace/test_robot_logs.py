"""Logs of robots as they are written, each by its own library where it has one: read beside an MJCF without an option.

LeRobot's own writer brings torch along; its layout (huggingface.co/docs/lerobot, dataset v3) is written here by
pyarrow.
PlotJuggler and SAGE are programs, whose CSV is written as theirs stands: `/topic/joint/field`, lists in cells.
"""

import json
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

import bench
from bench.errors import InputError
from bench.files import keeping, sha256, write_text
from bench.plant.robot import Robot, joint_rig, read_log, rig_within
from bench.rig.given import draft
from bench.rig.rig import Rig
from bench.trace.choose import GivenOptions
from bench.trace.inspect import inspect_recording
from bench.trace.read import read_recording
from tests.export.two_links import HIDDEN, MJCF, log, write_log
from tests.trace.formats import bag

JOINTS = ("shoulder", "elbow")
SIGNALS = ("position", "velocity", "torque")
FIELDS = ("position", "velocity", "effort")
STEMS = ("q", "dq", "tau")
PLAIN, PERIOD = replace(HIDDEN, cogging=0.0), 4e-3
COLUMNS = log(PLAIN, duration=6.0, period=PERIOD)
TIME = COLUMNS["time [s]"]
#: Signals of joints, as `SIGNALS` and `JOINTS` order them (n, 3, 2).
STATE = np.stack(
    [
        np.column_stack([next(v for k, v in COLUMNS.items() if k.startswith(f"{one}.{signal}")) for one in JOINTS])
        for signal in SIGNALS
    ],
    axis=1,
)
Q, W, TAU = np.moveaxis(STATE, 1, 0)


def csv(folder, names, columns, time="time", scale=1.0):
    head, path = ",".join((time, *names)), folder / "run.csv"
    np.savetxt(path, np.column_stack([TIME * scale, *columns]), "%.12g", ",", header=head, comments="")
    return path


def text(path, rows):
    path.write_text("".join(f"{row}\n" for row in rows))
    return path


def in_columns(name):
    """Names and columns of each signal of each joint, the first of them the shoulder's position."""
    pairs = [(signal, k) for k in range(2) for signal in range(3)]
    return [name(*pair) for pair in pairs], [STATE[:, signal, k] for signal, k in pairs]


def plotjuggler(folder):
    return csv(folder, *in_columns(lambda signal, k: f"/joint_states/{JOINTS[k]}/{FIELDS[signal]}"), "__time")


def numbered(folder):
    return csv(folder, *in_columns(lambda signal, k: f"{STEMS[signal]}_{k}"), "t")


def numbered_from_one(folder):
    names, columns = in_columns(lambda signal, k: f"{('pos', 'vel', 'tau')[signal]}_meas{k + 1}")
    others = (f"{other}{k}" for other in ("pos", "pos_filt", "tau_des") for k in (1, 2))
    return csv(folder, [*names, *others], [*columns, *[np.ones(TIME.size)] * 6])


def microseconds(folder):
    return csv(folder, *in_columns(lambda signal, k: f"{JOINTS[k]}_{SIGNALS[signal]}"), scale=1e6)


def sage(folder):
    rows = (",".join(f'"{values}"' for values in row) for row in STATE.tolist())
    lines = (f"STATE_MOTOR,{1e6 * t:.6f},{row}" for t, row in zip(TIME, rows, strict=True))
    return text(folder / "state_motor.csv", ["type,timestamp,positions,velocities,torques", *lines])


def a_joint_a_line(folder):
    rows = (
        f"{t:.6f},{one},{','.join(f'{value:.12g}' for value in state[:, k])}"
        for t, state in zip(TIME, STATE, strict=True)
        for k, one in enumerate(JOINTS)
    )
    return text(folder / "run.csv", ["time,joint,position,velocity,torque", *rows])


def a_value_a_line(folder):
    rows = (
        f"{t:.6f},/robot/{JOINTS[k]}/{field},{state[signal, k]:.12g}"
        for t, state in zip(TIME, STATE, strict=True)
        for signal, field in enumerate(FIELDS)
        for k in range(2)
    )
    return text(folder / "run.csv", ["timestamp,name,value", *rows])


def records(names, **more):
    """A sample each: its time and lists of the joints' numbers."""
    for t, state in zip(TIME, STATE.tolist(), strict=True):
        yield {"time": t, **more, **dict(zip(names, state, strict=True))}


def json_lines(folder):
    return text(folder / "run.jsonl", map(json.dumps, records(STEMS)))


def json_of_joint_states(folder):
    return text(folder / "run.json", [json.dumps(list(records(FIELDS, name=JOINTS)))])


def npz(folder):
    np.savez(folder / "run.npz", t=TIME, **dict(zip(STEMS, (Q, W, TAU), strict=True)))
    return folder / "run.npz"


def npz_with_names(folder):
    turned = dict(zip(("qpos", "qvel", "effort"), (Q[:, ::-1], W[:, ::-1], TAU[:, ::-1]), strict=True))
    np.savez(folder / "run.npz", time=TIME, joint_names=np.array(JOINTS[::-1]), **turned)
    return folder / "run.npz"


def lerobot(folder, episodes=2, scale=1.0):
    """Episodes in a file each, with times from zero; all that the arm reports is one list of state, as floats."""
    names = [f"main_{joint}.{word}" for joint in JOINTS for word in ("pos", "vel", "torque")]
    features = {
        "observation.state": {"dtype": "float32", "shape": [6], "names": names},
        "action": {"dtype": "float32", "shape": [2], "names": {"motors": names[::3]}},
        "observation.images.top": {"dtype": "video", "shape": [480, 640, 3], "names": ["height", "width", "rgb"]},
    }
    data = folder / "data" / "chunk-000"
    for one in (folder / "meta", data):
        one.mkdir(parents=True)
    info = {"codebase_version": "v3.0", "robot_type": "arm", "fps": 1.0 / PERIOD, "features": features}
    (folder / "meta" / "info.json").write_text(json.dumps(info))
    state = scale * STATE.swapaxes(1, 2)
    for number, piece in enumerate(np.array_split(np.arange(TIME.size), episodes)):
        frames = np.arange(piece.size)
        table = {
            "observation.state": pa.FixedSizeListArray.from_arrays(pa.array(state[piece].astype("f4").ravel()), 6),
            "action": pa.array(state[piece, :, 0].tolist(), pa.list_(pa.float32())),
            "timestamp": (frames * PERIOD).astype("f4"),
            "frame_index": frames,
            "episode_index": np.full(piece.size, number),
            "index": piece,
        }
        pq.write_table(pa.table(table), data / f"file-{number:03d}.parquet")
    return folder


def one_file_of_lerobot(folder):
    return lerobot(folder, 1) / "data" / "chunk-000" / "file-000.parquet"


def ros2_bag(folder, storage=StoragePlugin.SQLITE3):
    store = get_typestore(Stores.ROS2_JAZZY)
    kinds = ("sensor_msgs/msg/JointState", "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    joint_state, header, stamp = (store.types[name] for name in kinds)
    with Writer(folder / "bag", version=9, storage_plugin=storage) as writer:
        topic = writer.add_connection("/joint_states", joint_state.__msgtype__, typestore=store)
        for t, state in zip(TIME, STATE, strict=True):
            ns = 1_700_000_000_000_000_000 + round(t * 1e9)
            when = header(stamp=stamp(sec=ns // 10**9, nanosec=ns % 10**9), frame_id="")
            message = joint_state(header=when, name=list(JOINTS), **dict(zip(FIELDS, state.copy(), strict=True)))
            writer.write(topic, ns + 1_000_000, store.serialize_cdr(message, joint_state.__msgtype__))
    return folder / "bag"


def ros2_bag_of_mcap(folder):
    return ros2_bag(folder, StoragePlugin.MCAP)


def mcap(folder):
    return bag(folder / "run.mcap", TIME, JOINTS, STATE)


DIALECTS = (
    *(plotjuggler, numbered, numbered_from_one, microseconds, sage, a_joint_a_line, a_value_a_line, json_lines),
    *(json_of_joint_states, npz, npz_with_names, lerobot, one_file_of_lerobot, ros2_bag, ros2_bag_of_mcap, mcap),
)


@pytest.fixture(scope="module")
def elbow(tmp_path_factory):
    path = tmp_path_factory.mktemp("robot") / "arm.xml"
    path.write_text(MJCF)
    return Robot.of(path, "elbow")


@pytest.fixture(scope="module")
def known(elbow, tmp_path_factory):
    """The log in the names of the bench."""
    return read(write_log(tmp_path_factory.mktemp("known") / "known.csv", COLUMNS), elbow)


def read(path, robot, joints=None, **table):
    rig = Rig.of({"name": robot.joint, "kind": "rotary", "joints": joints or {}, **table})
    return read_log(path, rig_within(rig, robot), robot, {})


@pytest.mark.parametrize("write", DIALECTS)
def test_each_is_read_without_an_option(tmp_path, elbow, known, write):
    """The same samples of the same joint, and the same torque of the links, which needs the shoulder's, too."""
    trace = read(write(tmp_path), elbow)
    assert len(trace) == TIME.size
    assert len(trace.segments) == (2 if write is lerobot else 1)
    assert trace.sample_period == pytest.approx(PERIOD, rel=1e-4)
    for name, values in known.signals.items():
        np.testing.assert_allclose(trace[name], values, rtol=2e-5, atol=2e-5, err_msg=name)


def test_a_dataset_is_identified_and_says_what_it_was_taken_for(tmp_path, elbow):
    """Between two episodes lie ten sample periods."""
    trace = read(lerobot(tmp_path), elbow)
    found = bench.identify(trace, rig_within(Rig.of({"name": "elbow", "kind": "rotary"}), elbow))
    assert found["armature"].value == pytest.approx(PLAIN.armature, rel=0.02)
    assert found["coulomb_friction_torque"].value == pytest.approx(PLAIN.coulomb, rel=0.03)
    assert "main_elbow is elbow" in trace.notes
    assert any("2 episodes in sequence" in note for note in trace.notes)
    first = (TIME.size + 1) // 2
    assert np.diff(trace.time)[first - 1] == pytest.approx(10 * PERIOD, rel=1e-3)


def test_what_is_assumed_is_said(tmp_path, elbow):
    notes = " | ".join(read(sage(tmp_path), elbow).notes)
    order = "joints 0 to 1 are taken in the robot's order: shoulder, elbow"
    assert [said for said in (order, "torque taken as N*m", "time taken as us") if said not in notes] == []


def test_a_rig_names_columns_gains_and_signs_of_joints(tmp_path, elbow, known):
    """The log of an elbow whose motor is recorded, in A and the other way round, in columns that say little."""
    ratio, constant = 8.0, 0.5
    own = -np.rad2deg(ratio * Q[:, 1]), -ratio * W[:, 1], -TAU[:, 1] / ratio / constant
    path = csv(tmp_path, ["a0", "a1", "b0", "b1", "b2"], [Q[:, 0], W[:, 0], *own])
    joints = {
        "shoulder": {"columns": {"position": "a0", "velocity": "a1"}},
        "elbow": {
            "columns": {"position": "b0 [deg]", "velocity": "b1", "current": "b2"},
            "sign": -1,
            "torque_constant": "0.5 N*m/A",
            "gear_ratio": ratio,
        },
    }
    rig = joint_rig(Rig.of({"name": "elbow", "kind": "rotary", "joints": joints}), elbow)
    trace = read_log(path, rig, elbow, {})
    np.testing.assert_allclose(trace["position"], ratio * Q[:, 1], atol=1e-7)
    np.testing.assert_allclose(trace["known_torque"], known["known_torque"] / ratio, atol=1e-6)
    assert bench.identify(trace, rig)["armature"].value == pytest.approx(PLAIN.armature, rel=0.02)


def test_amperes_beside_an_mjcf_need_a_torque_constant(tmp_path, elbow):
    path = csv(tmp_path, *in_columns(lambda signal, k: f"{JOINTS[k]}.{('position', 'velocity', 'current')[signal]}"))
    asked = r"joint 'elbow': found an effort in A.*torque_constant under \[joints.elbow\]"
    with pytest.raises(InputError, match=asked):
        read(path, elbow)
    assert read(path, elbow, motor={"torque_constant": "1 N*m/A"}).units["current"] == "A"


def test_degrees_without_a_unit_are_not_taken_for_radians(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(MJCF.replace('name="shoulder"', 'name="shoulder" range="-100 100" limited="true"'))
    with pytest.raises(InputError, match=r"joint 'shoulder': is at -3.*allowed: -1.745 to 1.745 rad"):
        read(lerobot(tmp_path / "log", scale=np.rad2deg(1.0)), Robot.of(path, "elbow"))


def test_a_joint_that_no_name_tells_is_asked_for(tmp_path, elbow):
    """Three numbers for two joints: which are they?"""
    path, joints = csv(tmp_path, ["q_0", "q_1", "q_2"], [Q[:, 0]] * 3), {}
    given = {"elbow": {"axis": "2", "columns": {"torque": "q_0"}}, "shoulder": {"axis": "1"}}
    for joint, axis in given.items():
        asked = rf"joint '{joint}'.*\(0, 1, 2\): `axis = \"0\"` under \[joints.{joint}\]"
        with pytest.raises(InputError, match=asked):
            read(path, elbow, joints)
        joints[joint] = axis
    np.testing.assert_allclose(read(path, elbow, joints)["position"], Q[:, 0])


def test_a_joint_that_slides_has_its_effort_in_newtons(tmp_path):
    """ROS has all efforts of one message; of a joint that slides they are N, its positions m."""
    path = tmp_path / "arm.xml"
    path.write_text(MJCF.replace('<joint name="elbow"', '<joint name="elbow" type="slide"'))
    trace = read(mcap(tmp_path), Robot.of(path, "elbow"), kind="linear")
    assert dict(trace.units).items() >= {"position": "m", "velocity": "m/s", "force": "N"}.items()


URDF = """<robot name="arm"><link name="base"/>
  <link name="upper"><inertial><origin xyz="0 0 -0.16"/><mass value="1.3"/>
    <inertia ixx="0.014" iyy="0.014" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://arm/upper.dae"/></geometry></visual>
    <collision><geometry><mesh filename="package://arm/upper.stl"/></geometry></collision></link>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
</robot>"""


def test_a_urdf_is_taken_without_the_meshes_that_are_not_there(tmp_path):
    robot = Robot.of(text(tmp_path / "arm.urdf", [URDF]), "shoulder")
    assert robot.inertia == pytest.approx(0.014 + 1.3 * 0.16**2, rel=1e-9)
    trace = read(write_log(tmp_path / "log.csv", COLUMNS), robot)
    assert "meshes that do not exist are omitted from arm.urdf: upper" in trace.notes


def test_outputs_stay_out_of_a_dataset(tmp_path):
    root = lerobot(tmp_path / "log")
    before = sha256(root)
    with keeping([root]):
        read_recording(root)
        for file in (root / "meta" / "info.json", next(root.rglob("*.parquet"))):
            with pytest.raises(InputError, match="is an input of this command"):
                write_text(file, "{}")
    assert sha256(root) == before
    (root / "meta" / "info.json").write_text("{}")
    assert sha256(root) != before


@pytest.mark.parametrize(
    ("file", "content", "says"),
    [
        ("info.json", '{"codebase_version": 1, "features": ', "JSON"),
        ("*.parquet", None, "found no Parquet under data"),
        ("*.parquet", "PAR1 and no more", "truncated or damaged"),
    ],
    ids=["no info", "no data", "cut"],
)
def test_a_broken_dataset_is_one_line(tmp_path, file, content, says):
    root = lerobot(tmp_path / "log")
    for one in root.rglob(file):
        if content is None:
            one.unlink()
        else:
            one.write_text(content)
    with pytest.raises(InputError, match=says) as error:
        read_recording(root)
    assert "\n" not in str(error.value)


def test_inspect_says_which_column_is_what_and_begins_a_rig(tmp_path):
    """No column is taken for another signal than its name says, whatever its values resemble."""
    names, columns = in_columns(lambda signal, k: f"{('shoulder_lift', 'elbow')[k]}_joint.{SIGNALS[signal]}")
    found = inspect_recording(read_recording(csv(tmp_path, names, columns)), GivenOptions())
    assert {one.name: one.signal for one in found.columns} == {name: name.split(".")[-1] for name in ("time", *names)}
    assert found.axes == ("shoulder_lift_joint", "elbow_joint")
    rig = bench.load_rig(text(tmp_path / "rig.toml", [draft(found)]))
    assert rig.joints["elbow_joint"].columns == {signal: f"elbow_joint.{signal}" for signal in SIGNALS}


def test_a_column_of_two_states_in_turn_is_no_joint(tmp_path):
    rows = (f"{k},{k},{'ab'[k // 7 % 2]}" for k in range(100))
    path = text(tmp_path / "run.csv", ["time,velocity,phase", *rows])
    assert [channel.values.size for channel in read_recording(path).channels[:2]] == [100, 100]
