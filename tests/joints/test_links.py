"""A link's inertia that the MJCF has wrong, and what a body carried: both determined by all joints together."""

from dataclasses import replace

import numpy as np
import pytest

from bench.errors import InputError, UndeterminedError
from bench.export.mjcf import robot_with
from bench.joints.identified import JointLogs
from bench.joints.links import doubt_links, seek_payload, shared
from bench.joints.weight import OWN
from bench.plant.robot import AddedBody, Robot
from tests.export.two_links import C2, HIDDEN, I2, M2, MJCF, elbow_torque, log, motion, shoulder_torque, write_log
from tests.joints import ur5e

#: The forearm's inertia about its centre, and as an MJCF has it that counts the parallel-axis share twice.
ONCE, TWICE = (f'diaginertia="{own} {own} 1e-3"' for own in (I2, I2 + M2 * C2**2))
#: What the forearm carries at the lower end: kg, m.
MASS, DOWN = 0.5, 0.3


def of_arm(folder, columns, text=MJCF):
    """What is asked of both joints."""
    (folder / "arm.xml").write_text(text)
    logged = write_log(folder / "log.csv", columns)
    return [JointLogs(joint, folder / "arm.xml", (logged,)) for joint in ("shoulder", "elbow")]


def test_an_inertia_that_is_counted_twice_is_reported_with_its_factor(tmp_path):
    assert ONCE in MJCF
    columns = log(replace(HIDDEN, cogging=0.0))
    ((found, factor),) = doubt_links(of_arm(tmp_path, columns, MJCF.replace(ONCE, TWICE))).items()
    assert found.joint == "elbow"
    assert factor.value == pytest.approx((I2 + M2 * C2**2) / (I2 + 2.0 * M2 * C2**2), rel=0.01)
    assert not doubt_links(of_arm(tmp_path, columns))


def test_more_inertia_of_a_link_is_that_about_its_joint(tmp_path):
    (tmp_path / "arm.xml").write_text(MJCF)
    plain, more = (Robot.of(tmp_path / "arm.xml", "elbow", a) for a in ((), (AddedBody(joint="elbow", inertia=0.25),)))
    assert more.inertia - plain.inertia == pytest.approx(0.25, abs=1e-5)
    assert plain.link_inertia == pytest.approx(I2 + M2 * C2**2, rel=1e-12)


def carried(columns):
    """The same log with a point of mass at the lower end of the forearm, by the links' equations of a heavier one."""
    _, shoulder, elbow = motion()
    whole, first = M2 + MASS, M2 * C2 + MASS * DOWN
    heavier = whole, first / whole, I2 + M2 * C2**2 + MASS * DOWN**2 - first**2 / whole
    for joint, torque in (("shoulder", shoulder_torque), ("elbow", elbow_torque)):
        more = torque(*shoulder, *elbow, forearm=heavier) - torque(*shoulder, *elbow)
        columns[f"{joint}.torque [N*m]"] = columns[f"{joint}.torque [N*m]"] + more
    return columns


def test_a_payload_is_found_with_its_place(tmp_path):
    """In the plane of the arm: across it no motion tells."""
    found = seek_payload(of_arm(tmp_path, carried(log())), "forearm", lambda share: None)
    x, y, z = found.centre
    assert found.mass.value == pytest.approx(MASS, rel=0.02)
    assert found.mass.ci95[0] < MASS < found.mass.ci95[1]
    assert x.value == pytest.approx(0.0, abs=0.005)
    assert z.value == pytest.approx(-DOWN, abs=0.005)
    assert y.half_width == float("inf")


def test_where_nothing_is_carried_no_payload_is_reported(tmp_path):
    with pytest.raises(UndeterminedError, match="the payload of 'forearm' cannot be determined: its mass comes out as"):
        seek_payload(of_arm(tmp_path, log(replace(HIDDEN, cogging=0.0))), "forearm", lambda share: None)


def test_what_it_carries_and_what_its_link_has_more_are_in_the_mjcf(tmp_path):
    before = tmp_path / "arm.xml"
    before.write_text(MJCF)
    added = (AddedBody("forearm", MASS, (0.0, 0.0, -DOWN)), AddedBody(joint="elbow", inertia=0.003))
    text, lines = robot_with(before, {}, tmp_path / "after.xml", added)
    (tmp_path / "after.xml").write_text(text)
    was, found = (Robot.of(tmp_path / name, "elbow") for name in ("arm.xml", "after.xml"))
    assert found.inertia - was.inertia == pytest.approx(MASS * DOWN**2 + 0.003, abs=5e-6)
    assert found.link_inertia - was.link_inertia == pytest.approx(0.003, rel=1e-6)
    assert found.model.body_mass.sum() - was.model.body_mass.sum() == pytest.approx(MASS)
    assert [line.split(":")[0] for line in lines] == ["forearm", "elbow"]


def test_a_link_has_no_less_than_nothing(tmp_path):
    (tmp_path / "arm.xml").write_text(MJCF)
    text, (line,) = robot_with(tmp_path / "arm.xml", {}, tmp_path / "x.xml", (AddedBody(joint="elbow", inertia=-1.0),))
    (tmp_path / "x.xml").write_text(text)
    assert "keeps the MJCF's inertia" in line
    assert Robot.of(tmp_path / "x.xml", "elbow").link_inertia == pytest.approx(I2 + M2 * C2**2, rel=1e-6)


def test_a_body_that_is_not_there_is_named(tmp_path):
    (tmp_path / "arm.xml").write_text(MJCF)
    with pytest.raises(InputError, match="found no body 'foream', did you mean 'forearm'"):
        seek_payload(of_arm(tmp_path, log()), "foream", lambda share: None)
    with pytest.raises(InputError, match="found no body 'foream', did you mean 'forearm'"):
        Robot.of(tmp_path / "arm.xml", "elbow", (AddedBody("foream", 1.0),))


def test_friction_that_takes_nearly_all_torque_doubts_no_link(tmp_path):
    """The torque of a joint that always drives is its own magnitude along the motion, as which it explained itself."""
    (tmp_path / "arm.xml").write_text(ur5e.mjcf())
    hidden = [*(replace(one, effect="") for one in ur5e.HIDDEN[:5]), ur5e.Hidden(0.05, 0.8, 1.0)]
    logged = write_log(tmp_path / "log.csv", ur5e.log(hidden, seed=0, duration=10.0))
    assert not doubt_links([JointLogs(joint, tmp_path / "arm.xml", (logged,)) for joint in ur5e.NAMES])


def products(seed, factor=1.0, strengths=(0.8, -0.3, 0.0)):
    """Of two joints by 24 stretches: their own columns, three common ones, of which the last is rounding, and an effort
    with white noise; all of it in a unit that is a factor smaller.
    """
    rng, found = np.random.default_rng(seed), []
    for noise in (0.1, 0.3):
        columns = rng.normal(size=(960, OWN + 3)) * np.append(np.ones(OWN + 2), 1e-9)
        effort = columns @ [*rng.normal(size=OWN), *strengths] + noise * rng.normal(size=960)
        table = factor * np.column_stack([columns, effort])
        found.append(np.array([part.T @ part for part in np.split(table, 24)]))
    return found


@pytest.mark.parametrize("factor", [1e-4, 1e4])
def test_common_strengths_and_which_nothing_shows_do_not_depend_on_the_unit(factor):
    once, other = (shared(products(0, by), range(3)) for by in (1.0, factor))
    assert once.open.tolist() == other.open.tolist() == [False, False, True]
    np.testing.assert_allclose(other.strengths[:2], once.strengths[:2], rtol=1e-9)
    np.testing.assert_allclose(other.deviations[:2], once.deviations[:2], rtol=1e-9)


def test_common_strengths_scatter_as_their_errors_say_by_the_quieter_joint_most():
    """s**2/n of each joint's own noise, both together."""
    found = [shared(products(seed), range(2)) for seed in range(60)]
    strengths, errors = np.array([each.strengths for each in found]), np.array([each.deviations for each in found])
    expected = 1.0 / np.sqrt(960.0 / 0.1**2 + 960.0 / 0.3**2)
    print(f"\nscatter {strengths.std(axis=0)}, errors {np.mean(errors, axis=0)}, white noise {expected:.3g}")
    assert strengths.mean(axis=0) == pytest.approx([0.8, -0.3], abs=4.0 * expected / np.sqrt(60.0))
    assert strengths.std(axis=0) == pytest.approx(expected, rel=0.35)
    assert np.mean(errors, axis=0) == pytest.approx(expected, rel=0.15)
