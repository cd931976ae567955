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
from mcap_ros2.writer import Writer as Ros2Writer
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

import bench
from bench.errors import InputError
from bench.plant.robot import Robot, joint_rig, read_log, rig_within
from bench.rig.given import draft
from bench.rig.rig import Rig
from bench.trace.choose import GivenOptions
from bench.trace.inspect import inspect_recording
from bench.trace.read import read_recording
from tests.export.two_links import HIDDEN, MJCF, log, write_log
from tests.shared import SHARED, needs_shared
from tests.trace.test_containers import JOINT_STATE

JOINTS = ("shoulder", "elbow")
SIGNALS = ("position", "velocity", "torque")
PLAIN = replace(HIDDEN, cogging=0.0)
COLUMNS = log(PLAIN, duration=6.0, period=2e-3)
TIME = COLUMNS["time [s]"]
#: (n, joints) of each signal.
STATE = {
    signal: np.column_stack([next(v for k, v in COLUMNS.items() if k.startswith(f"{one}.{signal}")) for one in JOINTS])
    for signal in SIGNALS
}
ROWS = [[STATE[signal][k].tolist() for signal in SIGNALS] for k in range(TIME.size)]
STEM = {"position": "q", "velocity": "dq", "torque": "tau"}
FIELD = {"position": "position", "velocity": "velocity", "torque": "effort"}


def csv(path, names, columns, time="time", scale=1.0):
    np.savetxt(
        path, np.column_stack([TIME * scale, *columns]), "%.12g", ",", header=",".join((time, *names)), comments=""
    )
    return path


def in_columns(name):
    """Names and columns of each signal of each joint, the first of them the shoulder's position."""
    pairs = [(signal, k) for k in range(len(JOINTS)) for signal in SIGNALS]
    return [name(signal, k) for signal, k in pairs], [STATE[signal][:, k] for signal, k in pairs]


def plotjuggler(folder):
    names, columns = in_columns(lambda signal, k: f"/joint_states/{JOINTS[k]}/{FIELD[signal]}")
    return csv(folder / "run.csv", names, columns, "__time")


def numbered(folder):
    return csv(folder / "run.csv", *in_columns(lambda signal, k: f"{STEM[signal]}_{k}"), "t")


def numbered_from_one(folder):
    words = {"position": "pos_meas", "velocity": "vel_meas", "torque": "tau_meas"}
    names, columns = in_columns(lambda signal, k: f"{words[signal]}{k + 1}")
    others = (f"{other}{k}" for other in ("pos", "pos_filt", "tau_des") for k in (1, 2))
    return csv(folder / "run.csv", [*names, *others], [*columns, *[np.ones(TIME.size)] * 6])


def microseconds(folder):
    return csv(folder / "run.csv", *in_columns(lambda signal, k: f"{JOINTS[k]}_{signal}"), scale=1e6)


def sage(folder):
    cells = (",".join(f'"{values}"' for values in row) for row in ROWS)
    lines = [f"STATE_MOTOR,{1e6 * t:.6f},{row}" for t, row in zip(TIME, cells, strict=True)]
    path = folder / "state_motor.csv"
    path.write_text("\n".join(["type,timestamp,positions,velocities,torques", *lines, ""]))
    return path


def a_joint_a_line(folder):
    lines = ["time,joint,position,velocity,torque"]
    for k, t in enumerate(TIME):
        lines += [
            f"{t:.6f},{one},{','.join(f'{STATE[s][k, j]:.12g}' for s in SIGNALS)}" for j, one in enumerate(JOINTS)
        ]
    path = folder / "run.csv"
    path.write_text("\n".join([*lines, ""]))
    return path


def a_value_a_line(folder):
    lines = ["timestamp,name,value"]
    for k, t in enumerate(TIME):
        pairs = ((s, j) for s in SIGNALS for j in range(2))
        lines += [f"{t:.6f},/robot/{JOINTS[j]}/{FIELD[s]},{STATE[s][k, j]:.12g}" for s, j in pairs]
    path = folder / "run.csv"
    path.write_text("\n".join([*lines, ""]))
    return path


def json_lines(folder):
    path = folder / "run.jsonl"
    rows = ({"t": t, **dict(zip(("q", "dq", "tau"), row, strict=True))} for t, row in zip(TIME, ROWS, strict=True))
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    return path


def json_of_joint_states(folder):
    fields = ("position", "velocity", "effort")
    states = (
        {"stamp": t, "name": JOINTS, **dict(zip(fields, row, strict=True))} for t, row in zip(TIME, ROWS, strict=True)
    )
    path = folder / "run.json"
    path.write_text(json.dumps([{"time": state.pop("stamp"), **state} for state in states]))
    return path


def npz(folder):
    np.savez(folder / "run.npz", t=TIME, **{STEM[signal]: values for signal, values in STATE.items()})
    return folder / "run.npz"


def npz_with_names(folder):
    state = {f"q{name}": STATE[signal] for name, signal in (("pos", "position"), ("vel", "velocity"))}
    turned = {name: values[:, ::-1] for name, values in {**state, "effort": STATE["torque"]}.items()}
    np.savez(folder / "run.npz", time=TIME, joint_names=np.array(JOINTS[::-1]), **turned)
    return folder / "run.npz"


def lerobot(folder, episodes=2, scale=1.0):
    """Episodes in a file each, with times from zero; all that the arm reports is one list of state, as floats."""
    words = {"position": "pos", "velocity": "vel", "torque": "torque"}
    names = [f"main_{joint}.{words[signal]}" for joint in JOINTS for signal in SIGNALS]
    columns = {"observation.state": names, "action": {"motors": names[::3]}}
    features = {
        name: {"dtype": "float32", "shape": [6 if isinstance(names, list) else 2], "names": names}
        for name, names in columns.items()
    }
    features["observation.images.top"] = {"dtype": "video", "shape": [480, 640, 3], "names": ["height", "width", "rgb"]}
    (folder / "meta").mkdir(parents=True)
    info = {"codebase_version": "v3.0", "robot_type": "arm", "fps": 500, "features": features}
    (folder / "meta" / "info.json").write_text(json.dumps(info))
    (folder / "data" / "chunk-000").mkdir(parents=True)
    state = scale * np.stack([STATE[signal] for signal in SIGNALS], axis=2)
    for number, piece in enumerate(np.array_split(np.arange(TIME.size), episodes)):
        frames = np.arange(piece.size)
        table = pa.table(
            {
                "observation.state": pa.FixedSizeListArray.from_arrays(pa.array(state[piece].astype("f4").ravel()), 6),
                "action": pa.array(state[piece, :, 0].tolist(), pa.list_(pa.float32())),
                "timestamp": (frames * 2e-3).astype("f4"),
                "frame_index": frames,
                "episode_index": np.full(piece.size, number),
                "index": piece,
            }
        )
        pq.write_table(table, folder / "data" / "chunk-000" / f"file-{number:03d}.parquet")
    return folder


def one_file_of_lerobot(folder):
    return lerobot(folder, 1) / "data" / "chunk-000" / "file-000.parquet"


def ros2_bag(folder, storage=StoragePlugin.SQLITE3):
    store = get_typestore(Stores.ROS2_JAZZY)
    state, header, stamp = (
        store.types[name]
        for name in ("sensor_msgs/msg/JointState", "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    )
    with Writer(folder / "bag", version=9, storage_plugin=storage) as writer:
        topic = writer.add_connection("/joint_states", state.__msgtype__, typestore=store)
        for t, row in zip(TIME, ROWS, strict=True):
            ns = 1_700_000_000_000_000_000 + round(t * 1e9)
            when = header(stamp=stamp(sec=ns // 10**9, nanosec=ns % 10**9), frame_id="")
            message = state(header=when, name=list(JOINTS), **{
                name: np.array(values) for name, values in zip(("position", "velocity", "effort"), row, strict=True)
            })  # fmt: skip
            writer.write(topic, ns + 1_000_000, store.serialize_cdr(message, state.__msgtype__))
    return folder / "bag"


def ros2_bag_of_mcap(folder):
    return ros2_bag(folder, StoragePlugin.MCAP)


def mcap(folder):
    with (folder / "run.mcap").open("wb") as file:
        writer = Ros2Writer(file)
        states = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        for t, row in zip(TIME, ROWS, strict=True):
            ns = 1_700_000_000_000_000_000 + round(t * 1e9)
            stamp = {"sec": ns // 10**9, "nanosec": ns % 10**9}
            message = dict(zip(("position", "velocity", "effort"), row, strict=True))
            message |= {"header": {"stamp": stamp, "frame_id": ""}, "name": list(JOINTS)}
            writer.write_message("/joint_states", states, message, log_time=ns, publish_time=ns)
        writer.finish()
    return folder / "run.mcap"


DIALECTS = (
    *(plotjuggler, numbered, numbered_from_one, microseconds, sage, a_joint_a_line, a_value_a_line, json_lines),
    *(json_of_joint_states, npz, npz_with_names, lerobot, one_file_of_lerobot, ros2_bag, ros2_bag_of_mcap, mcap),
)


@pytest.fixture(scope="module")
def elbow(tmp_path_factory):
    path = tmp_path_factory.mktemp("robot") / "arm.xml"
    path.write_text(MJCF)
    return Robot.of(path, "elbow")


def read(path, robot, table=None):
    rig = Rig.of({"name": robot.joint, "kind": "rotary", **(table or {})})
    return read_log(path, rig_within(rig, robot), robot, {})


@pytest.mark.parametrize("write", DIALECTS)
def test_each_is_read_without_an_option(tmp_path, elbow, write):
    """The same samples of the same joint, and the same torque of the links, which needs the shoulder's, too."""
    known = read(write_log(tmp_path / "known.csv", COLUMNS), elbow)
    (tmp_path / "log").mkdir()
    trace = read(write(tmp_path / "log"), elbow)
    assert len(trace) == TIME.size
    assert len(trace.segments) == (2 if write is lerobot else 1)
    assert trace.sample_period == pytest.approx(2e-3, rel=1e-4)
    for name, values in known.signals.items():
        np.testing.assert_allclose(trace[name], values, rtol=2e-5, atol=2e-5, err_msg=name)


def test_the_joint_is_identified_from_a_dataset(tmp_path, elbow):
    rig = rig_within(Rig.of({"name": "elbow", "kind": "rotary"}), elbow)
    found = bench.identify(read_log(lerobot(tmp_path / "log"), rig, elbow, {}), rig)
    assert found["armature"].value == pytest.approx(PLAIN.armature, rel=0.02)
    assert found["coulomb_friction_torque"].value == pytest.approx(PLAIN.coulomb, rel=0.03)


def test_what_is_assumed_is_said(tmp_path, elbow):
    notes = " | ".join(read(sage(tmp_path), elbow).notes)
    for said in (
        "joints 0 to 1 are taken in the robot's order: shoulder, elbow",
        "torque taken as N*m",
        "time taken as us",
    ):
        assert said in notes
    (tmp_path / "log").mkdir()
    assert "main_elbow is elbow" in read(lerobot(tmp_path / "log"), elbow).notes


def test_a_rig_names_columns_gains_and_signs_of_joints(tmp_path, elbow):
    """The log of an elbow whose motor is recorded, in A and the other way round, in columns that say little."""
    ratio, constant, columns = 8.0, 0.5, dict(COLUMNS)
    state = {f"a{k}": columns[f"shoulder.{name}"] for k, name in enumerate(("position [rad]", "velocity [rad/s]"))}
    own = {"b0": -np.rad2deg(ratio * STATE["position"][:, 1]), "b1": -ratio * STATE["velocity"][:, 1]}
    own["b2"] = -STATE["torque"][:, 1] / ratio / constant
    path = csv(tmp_path / "run.csv", [*state, *own], [*state.values(), *own.values()])
    table = {
        "joints": {
            "shoulder": {"columns": {"position": "a0", "velocity": "a1"}},
            "elbow": {
                "columns": {"position": "b0 [deg]", "velocity": "b1", "current": "b2"},
                "sign": -1,
                "torque_constant": "0.5 N*m/A",
                "gear_ratio": 8.0,
            },
        }
    }
    rig = Rig.of({"name": "elbow", "kind": "rotary", **table})
    beside = joint_rig(rig, elbow)
    trace = read_log(path, beside, elbow, {})
    np.testing.assert_allclose(trace["position"], ratio * STATE["position"][:, 1], atol=1e-7)
    known = read(write_log(tmp_path / "known.csv", COLUMNS), elbow)
    np.testing.assert_allclose(trace["known_torque"], known["known_torque"] / ratio, atol=1e-6)
    found = bench.identify(trace, beside)
    assert found["armature"].value == pytest.approx(PLAIN.armature, rel=0.02)


def test_amperes_beside_an_mjcf_need_a_torque_constant(tmp_path, elbow):
    names, columns = in_columns(lambda signal, k: f"{JOINTS[k]}.{'current' if signal == 'torque' else signal}")
    path = csv(tmp_path / "run.csv", names, columns)
    with pytest.raises(
        InputError, match=r"joint 'elbow': found an effort in A.*torque_constant under \[joints.elbow\]"
    ):
        read(path, elbow)
    assert read(path, elbow, {"motor": {"torque_constant": "1 N*m/A"}}).units["current"] == "A"


def test_degrees_without_a_unit_are_not_taken_for_radians(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(MJCF.replace('name="shoulder"', 'name="shoulder" range="-100 100" limited="true"'))
    (tmp_path / "log").mkdir()
    with pytest.raises(InputError, match=r"joint 'shoulder': is at -3.*allowed: -1.745 to 1.745 rad"):
        read(lerobot(tmp_path / "log", scale=np.rad2deg(1.0)), Robot.of(path, "elbow"))


def test_a_joint_that_no_name_tells_is_asked_for(tmp_path, elbow):
    """Three numbers for two joints: which are they?"""
    columns = [STATE["position"][:, 0]] * 3
    path = csv(tmp_path / "run.csv", ["q_0", "q_1", "q_2"], columns)
    with pytest.raises(InputError, match=r"found 3 axes \(0, 1, 2\); pick one: `--axis 0`"):
        read(path, elbow)
    table = {"joints": {"elbow": {"axis": "2", "columns": {"torque": "q_0"}}}}
    with pytest.raises(InputError, match=r"joint 'shoulder'.*\(0, 1, 2\): axis = \"...\" under \[joints.shoulder\]"):
        read(path, elbow, table)
    table["joints"]["shoulder"] = {"axis": "1"}
    np.testing.assert_allclose(read(path, elbow, table)["position"], columns[0])


def test_a_joint_that_slides_has_its_effort_in_newtons(tmp_path):
    """ROS has all efforts of one message; of a joint that slides they are N, its positions m."""
    path = tmp_path / "arm.xml"
    path.write_text(MJCF.replace('<joint name="elbow"', '<joint name="elbow" type="slide"'))
    robot = Robot.of(path, "elbow")
    rig = Rig.of({"name": "elbow", "kind": "linear"})
    trace = read_log(mcap(tmp_path), rig_within(rig, robot), robot, {})
    assert dict(trace.units).items() >= {"position": "m", "velocity": "m/s", "force": "N"}.items()


URDF = """<robot name="arm"><link name="base"/>
  <link name="upper"><inertial><origin xyz="0 0 -0.16"/><mass value="1.3"/>
    <inertia ixx="0.014" iyy="0.014" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://arm/upper.dae"/></geometry></visual>
    <collision><geometry><mesh filename="package://arm/upper.stl"/></geometry></collision></link>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
</robot>"""


def test_a_urdf_is_taken_without_the_meshes_that_are_not_there(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(URDF)
    robot = Robot.of(path, "shoulder")
    assert robot.inertia == pytest.approx(0.014 + 1.3 * 0.16**2, rel=1e-9)
    trace = read(write_log(tmp_path / "log.csv", COLUMNS), robot)
    assert "meshes that do not exist are omitted from arm.urdf: upper" in trace.notes


def test_an_inertia_made_of_a_mesh_that_is_not_there_is_none(tmp_path):
    path = tmp_path / "arm.xml"
    body = '<body name="b"><joint name="j"/><geom type="mesh" mesh="m"/></body>'
    path.write_text(f'<mujoco><asset><mesh name="m" file="m.stl"/></asset><worldbody>{body}</worldbody></mujoco>')
    with pytest.raises(InputError, match="mesh 'm' does not exist, and the inertia of 'b' is computed from it"):
        Robot.of(path, "j")


def test_outputs_stay_out_of_a_dataset(tmp_path):
    from bench.files import keeping, sha256, write_text

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


BROKEN = {
    "no info": (lambda root: (root / "meta" / "info.json").write_text('{"codebase_version": 1, "features": '), "JSON"),
    "no data": (lambda root: [one.unlink() for one in root.rglob("*.parquet")], "found no Parquet under data"),
    "cut": (lambda root: cut(next(root.rglob("*.parquet"))), "truncated or damaged"),
}


def cut(path):
    path.write_bytes(path.read_bytes()[:300])


@pytest.mark.parametrize("fault", BROKEN)
def test_a_broken_dataset_is_one_line(tmp_path, fault):
    damage, says = BROKEN[fault]
    root = lerobot(tmp_path / "log")
    damage(root)
    with pytest.raises(InputError, match=says) as error:
        read_recording(root)
    assert "\n" not in str(error.value)


@needs_shared
@pytest.mark.parametrize("name", ["velocity_ramp", "backlash_detection"])
def test_lists_in_cells_as_sage_writes_them(name):
    recording = read_recording(SHARED / "data" / "robots" / "so101" / f"{name}.state_motor.csv.gz")
    joints = {channel.axis: channel for channel in recording.channels if channel.signal == "torque"}
    assert list(joints) == ["0", "1", "2", "3", "4", "5"]
    assert all(channel.values.size == 6000 for channel in joints.values())
    assert joints["2"].values[0] == pytest.approx(0.57 if name == "velocity_ramp" else 0.5, abs=0.01)


def test_inspect_says_which_column_is_what_and_begins_a_rig(tmp_path, elbow):
    """No column is taken for another signal than its name says, whatever its values resemble."""
    names, columns = in_columns(lambda signal, k: f"{('shoulder_lift', 'elbow')[k]}_joint.{signal}")
    path = csv(tmp_path / "run.csv", names, columns)
    found = inspect_recording(read_recording(path), GivenOptions())
    assert {one.name: one.signal for one in found.columns} == {
        "time": "time",
        **{name: name.rsplit(".", 1)[1] for name in names},
    }
    assert found.axes == ("shoulder_lift_joint", "elbow_joint")
    (tmp_path / "rig.toml").write_text(draft(found))
    rig = bench.load_rig(tmp_path / "rig.toml")
    assert rig.joints["elbow_joint"].columns == {signal: f"elbow_joint.{signal}" for signal in SIGNALS}


def test_a_column_of_two_states_in_turn_is_no_joint(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("time,velocity,phase\n" + "".join(f"{k},{k},{'ab'[k // 7 % 2]}\n" for k in range(100)))
    assert [channel.values.size for channel in read_recording(path).channels[:2]] == [100, 100]


def test_between_two_episodes_lie_ten_sample_periods(tmp_path, elbow):
    trace = read(lerobot(tmp_path / "log"), elbow)
    assert any("2 episodes in sequence" in note for note in trace.notes)
    time, first = trace.time, np.array_split(np.arange(TIME.size), 2)[0].size
    assert np.diff(time)[first - 1] == pytest.approx(10 * 2e-3, rel=1e-3)
