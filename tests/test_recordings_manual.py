"""The commands of docs/recordings.md run on files written as each recorder writes them, and find the truth."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from bench.trace.write import DEFINITION
from tests.docs.pages import PAGES, bench_commands, run_commands
from tests.fit.motions import NAMES, Truth, recording

SECTIONS = dict(re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", PAGES["docs/recordings.md"], re.MULTILINE | re.DOTALL))
TORQUE_CONSTANT = 0.8


@pytest.fixture(scope="module")
def axis():
    trace = recording(np.random.default_rng(3), duration=8.0, position=True)
    return trace.time, trace["position"], trace["velocity"], trace["current"]


def dynamixel(axis):
    time, position, velocity, current = axis
    counts = (position / (2 * np.pi) * 4096, velocity * 30 / np.pi / 0.229, current / 2.69e-3)
    rows = (f"{t:.3f},{p:.0f},{v:.0f},{c:.0f}" for t, p, v, c in zip(time, *counts, strict=True))
    Path("dxl.csv").write_text("\n".join(["timestamp,present_position,present_velocity,present_current", *rows]))


def sinamics(axis):
    time, _, velocity, current = axis
    head = "Zeit [ms];r63[0]: Drehzahlistwert geglättet [1/min];r80[0]: Drehmomentistwert geglättet [Nm]"
    speed, torque = velocity * 30 / np.pi, current * TORQUE_CONSTANT
    rows = (f"{1e3 * t:.3f};{v:.4f};{m:.5f}".replace(".", ",") for t, v, m in zip(time, speed, torque, strict=True))
    Path("trace.csv").write_bytes("\r\n".join([head, *rows]).encode("latin-1"))


def odrive(axis):
    time, position, velocity, current = axis
    turns = (position / (2 * np.pi), velocity / (2 * np.pi), current)
    rows = (f"{k},{t:.4f},{p:.6f},{v:.5f},{c:.5f}" for k, (t, p, v, c) in enumerate(zip(time, *turns, strict=True)))
    Path("odrive.csv").write_text("\n".join([",time,pos_estimate,vel_estimate,Iq_measured", *rows]))


def ros2(axis):
    writers = pytest.importorskip("mcap_ros2.writer")
    with Path("bag.mcap").open("wb") as file:
        writer = writers.Writer(file)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", DEFINITION)
        for t, p, v, c in zip(*(column.tolist() for column in axis), strict=True):
            stamp = 1_700_000_000_000_000_000 + round(t * 1e9)
            sec, nanosec = divmod(stamp, 10**9)
            message = {
                "header": {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": ""},
                "name": ["wrist", "elbow"],
                "position": [0.0, p],
                "velocity": [0.0, v],
                "effort": [0.0, c * TORQUE_CONSTANT],
            }
            writer.write_message("/joint_states", schema, message, log_time=stamp, publish_time=stamp)
        writer.finish()


RECORDERS = {
    "Dynamixel, a log of the control table": (dynamixel, 1.0 / TORQUE_CONSTANT),
    "SINAMICS, a trace saved as CSV": (sinamics, 1.0),
    "ODrive, a log by pandas": (odrive, 1.0 / TORQUE_CONSTANT),
    "A ROS 2 bag": (ros2, 1.0),
}


@pytest.mark.parametrize("section", RECORDERS)
def test_at_most_three_commands_lead_to_the_truth(section, axis, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write, factor = RECORDERS[section]
    write(axis)
    add = {True: " --json found.json", False: ""}
    done = run_commands(SECTIONS[section], lambda line: line + add[line.startswith("bench identify")])
    assert len(done) <= 3
    found = json.loads(Path("found.json").read_text())["parameters"]
    for name, value in zip(NAMES, Truth().values, strict=True):
        assert found[name]["value"] == pytest.approx(factor * value, rel=0.03), name
    if section == "A ROS 2 bag":
        assert any("wrist, elbow" in one.out for one in done)


def test_every_section_with_commands_is_run():
    assert {title for title, body in SECTIONS.items() if bench_commands(body)} == set(RECORDERS)
