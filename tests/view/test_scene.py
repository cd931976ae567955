"""The scene of a video: marks of model and ghost stand where their positions say."""

import numpy as np
import pytest

from bench.axis_kind import LINEAR
from bench.view.scene import TRAVEL, Scene
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
