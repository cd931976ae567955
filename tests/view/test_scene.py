"""The scene of a video: marks of model and ghost stand where their positions say."""

import numpy as np
import pytest

from bench.axis_kind import LINEAR
from bench.view.scene import TRAVEL, Scene
from bench.view.side_by_side import RobotAlong
from tests.export.two_links import L1, MJCF
from tests.view.motions import shown


def place(scene, name):
    return scene.data.geom(name).xpos


@pytest.mark.parametrize(("position", "ghost"), [(0.0, 0.0), (0.3, 1.2), (-2.0, 70.0)])
def test_a_disks_marks_turn_about_the_shaft(position, ghost):
    scene = Scene.of(shown(), None)
    scene.placed(position, ghost)
    for name, angle in (("angle mark", position), ("ghost angle mark", ghost)):
        across = place(scene, name) - place(scene, name.replace("angle mark", "disk"))
        found = np.arctan2(-across[1], across[2])  # of the shaft x, from the top
        assert np.cos(found - angle) == pytest.approx(1.0, abs=1e-12)


def test_a_slide_moves_along_its_rail_and_never_off_it():
    scene = Scene.of(shown(LINEAR), None)
    ends = []
    for position in (0.0, 6.02):
        scene.placed(position, np.nan)
        ends.append(place(scene, "slide")[0])
    assert np.diff(ends)[0] == pytest.approx(TRAVEL)
    assert sum(ends) == pytest.approx(0.0, abs=1e-12)
    short = Scene.of(shown(LINEAR, duration=0.1), None)
    short.placed(0.1, 0.2)
    assert (place(short, "ghost slide") - place(short, "slide"))[0] == pytest.approx(0.1)


def test_a_robot_moves_as_its_log_and_its_joint_as_model_and_ghost(tmp_path):
    """Places of a forearm's end by the angles of both joints; the upper arm has no ghost, and its motor a gear of 2."""
    link = '<geom name="upper" size="0.01"/><inertial pos="0 0 -0.16"'
    text = MJCF.replace('<inertial pos="0 0 -0.16"', link)
    text = text.replace(
        '<inertial pos="0 0 -0.15"', '<geom name="tip" pos="0 0 -0.3" size="0.01"/><inertial pos="0 0 -0.15"'
    )
    (tmp_path / "arm.xml").write_text(text)
    times = np.array([1.0, 2.0])
    poses = {"shoulder": np.array([0.2, 0.6]), "elbow": np.array([9.0, 9.0])}
    scene = Scene.of_robot(RobotAlong(tmp_path / "arm.xml", "elbow", 2.0, times, poses))
    scene.placed(-0.8, 1.4, 1.25)
    for name, elbow in (("tip", -0.4), ("ghost tip", 0.7)):
        along = np.array([0.3, 0.3 + elbow])  # shoulder between 0.2 and 0.6, about +y
        expected = -np.array([L1, 0.3]) @ np.column_stack([np.sin(along), np.zeros(2), np.cos(along)])
        np.testing.assert_allclose(place(scene, name), expected, atol=1e-9)
    alpha = {name: scene.model.geom(name).rgba[3] for name in ("upper", "ghost upper", "ghost tip")}
    assert alpha["upper"] == 1.0
    assert alpha["ghost upper"] == 0.0 < alpha["ghost tip"] < 1.0
