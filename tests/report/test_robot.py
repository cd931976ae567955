"""The document of a robot, whose page stays small however many joints it has."""

import re
from pathlib import Path

import numpy as np
import pytest

import bench
from bench.joints.identified import IdentifiedJoint
from bench.joints.robot import IdentifiedRobot
from bench.report.html import FOLDED, INSTANTS, PAGE, html
from bench.report.robot import robot
from bench.view.free_running import BARE, HELD
from bench.view.joint_motion import JointMotion
from tests.diagnosis.command import RIG
from tests.diagnosis.test_commands import run_of, with_unbalance
from tests.studies.whole_robots import humanoid

JOINTS = 29


@pytest.fixture(scope="module")
def many(tmp_path_factory):
    """Document of a humanoid whose joints all have the diagnosis of one axis, and their names."""
    folder = tmp_path_factory.mktemp("many")
    (folder / "rig.toml").write_text(RIG)
    (folder / "robot.xml").write_text(humanoid(JOINTS))
    names = re.findall(r'<joint name="([^"]+)"', (folder / "robot.xml").read_text())
    rig = bench.load_rig(folder / "rig.toml")
    found = bench.diagnose(with_unbalance(run_of(duration=4.0)), rig)
    time = np.linspace(0.0, 20.0, 1000)
    measured = {name: 0.3 * np.sin((1.0 + 0.1 * k) * time) for k, name in enumerate(names)}
    joints = {}
    for name, at in measured.items():
        runs = {HELD: at + 1e-3 * np.cos(time), BARE: at + 3e-3 * np.cos(5.0 * time)}
        motion = JointMotion("log.csv", "rad", time, measured, runs, time[1:50], time[1:50])
        joints[name] = IdentifiedJoint(name, rig, found, motion=motion)
    return robot(IdentifiedRobot(folder / "robot.xml", joints), "robot.xml: log.csv"), names


def test_a_page_of_many_joints_stays_small(many):
    document, names = many
    page = html(document)
    assert len(names) == JOINTS
    assert len(page.encode()) < PAGE
    counts = [int(count) for count in re.findall(r'"count":(\d+)', page)]
    assert len(counts) == 1 + JOINTS and counts[0] == INSTANTS
    assert min(counts[1:]) >= FOLDED
    assert all(f">{name}</h2>" in page for name in names)


def test_what_a_small_page_folds_is_made_again_by_its_script(many, opened, tmp_path):
    document, names = many
    (tmp_path / "page.html").write_text(html(document), encoding="utf-8")
    page = opened(tmp_path / "page.html")
    page.locator(".graph canvas").nth(JOINTS - 1).wait_for(state="attached")
    assert page.locator("[data-folded], script:empty").count() == 0
    own = page.locator(f"#joint-{JOINTS}")
    assert own.locator("h2").inner_text() == names[-1]
    assert (own.locator("table").count() >= 3, own.locator("figure.chart svg").count() >= 3) == (True, True)
    assert page.locator("figure.moving canvas").count() == 1
    phone = opened(tmp_path / "page.html", 390, color_scheme="dark")
    phone.locator(".graph canvas").nth(JOINTS - 1).wait_for(state="attached")
    assert phone.evaluate("document.documentElement.scrollWidth") <= 390


def test_a_warning_of_several_joints_is_listed_once():
    left_out = {"a": {"log": "no torque"}, "b": {"log": "no torque", "other": "too short"}, "c": {"log": "no torque"}}
    joints = {name: IdentifiedJoint(name, left_out=why) for name, why in left_out.items()}
    listed = robot(IdentifiedRobot(Path("robot.xml"), joints), "robot.xml").warnings
    assert listed == ("all joints: log is not used: no torque", "b: other is not used: too short")
    listed = robot(IdentifiedRobot(Path("robot.xml"), joints | {"d": IdentifiedJoint("d")}), "robot.xml").warnings
    assert listed == ("a, b, c: log is not used: no torque", "b: other is not used: too short")
