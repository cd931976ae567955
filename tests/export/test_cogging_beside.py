"""What `identify` makes of an elbow that has cogging, which its equation has not: a bias, reported and counted."""

import numpy as np
import pytest

from bench.fit.identify import identify
from bench.plant.robot import Robot, read_log, rig_within
from bench.rig.rig import Rig
from tests.export.two_links import HIDDEN, MJCF, log, motion, write_log


def armature(folder, duration, phase):
    """What a log tells, over the truth, and what it says of itself."""
    (folder / "robot.xml").write_text(MJCF)
    write_log(folder / "log.csv", log(duration=duration, phase=phase, seed=round(10 * phase)))
    robot = Robot.of(folder / "robot.xml", "elbow")
    rig = rig_within(Rig.of({"name": "elbow", "kind": "rotary"}), robot)
    estimate = identify(read_log(folder / "log.csv", rig, robot, {}), rig)
    return estimate.parameters["armature"], estimate.warnings


def projection(duration, phase):
    """What least squares make of the cogging in the place of armature, without filter and noise - kg*m**2."""
    _, _, (angle, speed, acceleration) = motion(duration=duration, phase=phase)
    columns = np.column_stack([acceleration, speed, np.sign(speed), np.ones_like(speed)])
    return np.linalg.lstsq(columns, HIDDEN.cogging * np.sin(HIDDEN.harmonic * angle), rcond=None)[0][0]


def test_a_short_log_counts_the_bias_in_its_interval_and_warns_and_a_longer_one_has_none(tmp_path):
    """Cogging goes along with the acceleration by chance of a short log: that is all there is to it."""
    found, warnings = armature(tmp_path, 12.0, 3.14)
    assert found.ci95[0] < HIDDEN.armature < found.ci95[1]
    assert any("`bench diagnose` searches for the cause" in warning for warning in warnings)
    off, expected = found.value - HIDDEN.armature, projection(12.0, 3.14)
    print(f"\n{100 * off / HIDDEN.armature:.2f} % off, of which {100 * expected / HIDDEN.armature:.2f} %")
    assert off == pytest.approx(expected, abs=0.005 * HIDDEN.armature)
    found, _ = armature(tmp_path, 24.0, 0.0)
    assert found.value == pytest.approx(HIDDEN.armature, rel=0.01)
    assert found.ci95[0] < HIDDEN.armature < found.ci95[1]


@pytest.mark.slow
@pytest.mark.parametrize("duration", [12.0, 24.0, 48.0, 96.0])
def test_intervals_hold_the_armature_whatever_the_motion(tmp_path, duration):
    off = []
    for phase in np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False):
        found, _ = armature(tmp_path, duration, float(phase))
        assert found.ci95[0] < HIDDEN.armature < found.ci95[1]
        off.append(100.0 * (found.value / HIDDEN.armature - 1.0))
    print(f"\n{duration:g} s: RMS {np.sqrt(np.mean(np.square(off))):.2f} %, {np.abs(off).max():.2f} % at most")
    assert duration == 12.0 or np.abs(off).max() < 1.0
