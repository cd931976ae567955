"""Where other joints' signals lag, identify and diagnose take the cut-off at which the inertia stands still."""

from dataclasses import replace

import numpy as np
import pytest

import bench
from bench.diagnosis.diagnosis import diagnose
from bench.effects.catalogue import catalogue
from bench.plant.robot import Robot, joint_rig, read_log
from tests.export.two_links import C2, HIDDEN, I2, M2, MJCF, log, write_log

PLAIN = replace(HIDDEN, cogging=0.0)
#: By which the shoulder's signals are late - s.
LATE = 0.015


@pytest.fixture
def read(tmp_path):
    """Reads columns as a log of the elbow; its rig and trace."""

    def reading(columns, mjcf=MJCF):
        (tmp_path / "arm.xml").write_text(mjcf)
        robot = Robot.of(tmp_path / "arm.xml", "elbow")
        rig = joint_rig(None, robot)
        return read_log(write_log(tmp_path / "log.csv", columns), rig, robot, {}), rig

    return reading


def test_both_tell_the_same_armature(read):
    columns = log(PLAIN)
    time = columns["time [s]"]
    for name in ("shoulder.position [rad]", "shoulder.velocity [rad/s]"):
        columns[name] = np.interp(time - LATE, time, columns[name])
    trace, rig = read(columns)
    by_identify = bench.identify(trace, rig)["armature"]
    by_diagnose = diagnose(trace, rig, excluded=frozenset(catalogue())).parameters["armature"]
    for found in (by_identify, by_diagnose):
        assert found.ci95[0] < PLAIN.armature < found.ci95[1]
    assert by_diagnose.value == pytest.approx(by_identify.value, abs=0.1 * by_identify.half_width)


def test_where_the_cut_off_is_lowered_gaps_before_and_after_are_of_the_same_rows(read):
    """Noise of the shoulder's speed is in the known torque: without an effect nothing is removed from the gap."""
    columns, rng = log(PLAIN), np.random.default_rng(3)
    columns["shoulder.velocity [rad/s]"] += 0.02 * rng.normal(size=columns["time [s]"].size)
    found = diagnose(*read(columns), excluded=frozenset(catalogue()))
    assert any("moves with the filter's cut-off" in warning for warning in found.warnings)
    assert found.torque.identify[0] == found.torque.identify[1]


def test_the_share_explained_is_that_of_the_measured_torque(read):
    """A log of noise alone where the links' torque is known: what is left is as large as what was measured."""
    columns = log(PLAIN)
    trace, rig = read(columns)
    measured, left = trace["torque"], bench.identify(trace, rig)
    by_hand = 1.0 - left.residual.rms**2 / np.var(measured)
    assert left.explained == pytest.approx(by_hand, abs=2e-4)
    heavy = MJCF.replace(f'diaginertia="{I2} ', f'diaginertia="{I2 + M2 * C2**2} ')
    assert heavy != MJCF
