"""A robot's file with the friction of its joints: URDF as MuJoCo's own reader has it, MJCF that can be moved."""

import shutil

import mujoco
import numpy as np
import pytest

from bench.export.mjcf import Armature, robot_with
from bench.export.urdf import urdf_with
from bench.files import write_text
from bench.plant.model_file import joints_toml
from tests.command import bench as command
from tests.export.arms import stored

RATIO = 12.0
COGGING = ("cogging_torque", {"amplitude": 0.4, "harmonic": 6.0, "phase": 0.3})
INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
URDF = f"""<robot name="arm"><!-- of the maker -->
  <link name="base">{INERTIAL}</link><link name="upper">{INERTIAL}</link><link name="fore">{INERTIAL}</link>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="90" velocity="3"/><dynamics damping="7"/></joint>
</robot>"""
MESHED = """<mujoco><compiler meshdir="meshes" texturedir="paint"/>
  <asset><mesh name="hull" file="part/hull.stl"/><mesh name="lid" file="lid/hull.stl"/></asset>
  <worldbody><body><joint name="elbow" axis="0 1 0"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
  <geom type="mesh" mesh="hull"/><geom type="mesh" mesh="lid"/></body></worldbody></mujoco>"""


def tetrahedron(size):
    """Binary STL of a tetrahedron."""
    corners = size * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype="<f4")
    faces = [corners[list(k)] for k in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))]
    body = b"".join(bytes(12) + face.tobytes() + bytes(2) for face in faces)
    return bytes(80) + (4).to_bytes(4, "little") + body


def test_a_urdf_has_the_friction_behind_the_gear_and_tells_what_it_lacks(tmp_path):
    (tmp_path / "arm.urdf").write_text(URDF)
    model = stored(COGGING, gear_ratio=RATIO)
    text, lines = urdf_with(tmp_path / "arm.urdf", {"elbow": model})
    (tmp_path / "out.urdf").write_text(text)
    read = mujoco.MjModel.from_xml_path(str(tmp_path / "out.urdf"))
    own, parameters = read.joint("elbow").dofadr[0], model.model.parameters
    assert read.dof_damping[own] == pytest.approx(parameters.viscous_friction_coefficient * RATIO**2)
    assert read.dof_frictionloss[own] == pytest.approx(parameters.coulomb_friction * RATIO)
    assert read.dof_damping[read.joint("shoulder").dofadr[0]] == 0.0
    assert "<!-- of the maker -->" in text
    assert 'effort="90"' in text
    assert any("armature" in line and "not carried" in line for line in lines)
    assert any("cogging_torque" in line and "not carried" in line for line in lines)


def test_a_robot_with_its_assets_can_be_moved(tmp_path):
    source, out, moved = tmp_path / "source", tmp_path / "out", tmp_path / "moved"
    for name, size in (("part", 1.0), ("lid", 2.0)):
        (source / "meshes" / name).mkdir(parents=True)
        (source / "meshes" / name / "hull.stl").write_bytes(tetrahedron(size))
    (source / "robot.xml").write_text(MESHED)
    models = {"elbow": (stored(gear_ratio=RATIO), Armature(0.01, "of a test"))}
    text, _ = robot_with(source / "robot.xml", models, out / "robot.xml", with_assets=True)
    write_text(out / "robot.xml", text)
    shutil.move(out, moved)
    shutil.rmtree(source)
    read = mujoco.MjModel.from_xml_path(str(moved / "robot.xml"))
    assert read.mesh_vertnum.tolist() == [4, 4]
    one, two = np.ptp(read.mesh_vert.reshape(2, 4, 3), axis=(1, 2))  # in the frames of their inertia
    assert max(one, two) / min(one, two) == pytest.approx(2.0, rel=1e-3)
    assert read.dof_armature[0] == 0.01


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "arm.urdf").write_text(URDF)
    (tmp_path / "arm.xml").write_text(
        MESHED.split("<asset>")[0] + "<worldbody><body><joint name='elbow'/><inertial "
        "pos='0 0 0' mass='1' diaginertia='1 1 1'/></body></worldbody></mujoco>"
    )
    write_text(tmp_path / "joints.toml", joints_toml({"elbow": stored(gear_ratio=RATIO)}))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("--mjcf arm.urdf --joint elbow --out id.urdf", "elbow: not carried: armature"),
        ("--mjcf arm.urdf --joint elbow --out id.xml --armature all", "elbow: no effect beyond friction"),
        ("--to mjcf --joint elbow --out joint.xml", "behind a gear of 12"),
    ],
)
def test_a_robots_file_is_written_as_its_ending_says(folder, line, says):
    done = command("export", "joints.toml", *line.split())
    assert (done.status, says in done.out) == (0, True), done.err + done.out
    mujoco.MjModel.from_xml_path(line.split("--out ")[1].split()[0])


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("--mjcf arm.xml --joint elbow --out id.urdf", "id.urdf: found a URDF to be written from arm.xml, an MJCF"),
        ("--mjcf arm.urdf --joint elbo --out id.urdf", "found no 'elbo'; allowed: elbow"),
        ("--to bam --joint elbow --out id.json --with-assets", "--with-assets: found without --mjcf"),
    ],
)
def test_what_a_robots_file_cannot_be_is_one_line(folder, line, says):
    done = command("export", "joints.toml", *line.split())
    assert (done.status, says in done.err) == (2, True), done.err
    assert len(done.err.strip().splitlines()) == 1
