"""A robot in a page: its triangles are few and lie on its meshes, and its links stand where their joints say."""

import struct

import numpy as np
import pytest

from bench.report.over_time import unpacked
from bench.report.publish import write_html
from bench.report.robot_drawing import BUDGET, robot_drawing, simplified
from bench.report.simulation import view
from bench.view.side_by_side import RobotAlong
from tests.export.two_links import C2, L1, MJCF
from tests.view.motions import AHEAD, SPEED, shown

TIP, RATIO, TILT = 0.3, 2.0, 0.35
RED, BLUE = "1 0 0 1", "0 0 1 1"


def ball(radius, around=80, along=60):
    """Triangles (t, 3, 3) of a sphere about zero."""
    u, v = np.meshgrid(np.linspace(0.0, np.pi, along), 2.0 * np.pi * np.arange(around) / around)
    at = radius * np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=-1)
    beside = np.roll(at, -1, axis=0)
    corners = at[:, :-1], beside[:, :-1], beside[:, 1:], at[:, 1:]
    return np.concatenate(
        [np.stack([corners[k] for k in three], axis=2).reshape(-1, 3, 3) for three in ([0, 1, 2], [0, 2, 3])]
    )


def write_stl(path, triangles):
    """The binary format as its description has it."""
    record = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("of", "<u2")])
    record["corners"] = triangles
    path.write_bytes(bytes(80) + struct.pack("<I", len(triangles)) + record.tobytes())


def corners(shape):
    """Vertices (v, 3) that a page holds."""
    return unpacked(shape.vertices)[0].reshape(3, -1).T


@pytest.fixture
def arm(tmp_path):
    """Two links whose elbow and tip are balls from mesh files."""
    (tmp_path / "meshes").mkdir()
    write_stl(tmp_path / "meshes" / "ball.stl", ball(0.03))
    of = '<geom type="mesh" mesh="ball" mass="0" pos="0 0 {}" rgba="{}"/><inertial pos="0 0 -{}"'
    text = MJCF.replace('<inertial pos="0 0 -0.16"', of.format(-L1, BLUE, 0.16))
    text = text.replace('<inertial pos="0 0 -0.15"', of.format(-TIP, RED, 0.15))
    text = text.replace("<worldbody>", '<compiler meshdir="meshes"/><asset><mesh file="ball.stl"/></asset><worldbody>')
    assert text.count("mesh=") == 2
    (tmp_path / "arm.xml").write_text(text)
    return tmp_path / "arm.xml"


def test_a_mesh_becomes_few_triangles_that_lie_on_it():
    triangles = ball(0.2)
    vertices, faces = simplified(triangles.reshape(-1, 3), np.arange(triangles.shape[0] * 3).reshape(-1, 3), 500)
    assert 250 < len(faces) <= 500 < len(triangles) / 10
    np.testing.assert_allclose(np.linalg.norm(vertices, axis=1), 0.2, rtol=0.06)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    assert area == pytest.approx(4.0 * np.pi * 0.2**2, rel=0.1)  # closed, and no face lies inside


def test_shapes_of_mujoco_have_their_size(tmp_path):
    sizes = {"sphere": ".1", "capsule": ".1 .2", "cylinder": ".1 .2", "box": ".1 .2 .3", "ellipsoid": ".1 .2 .3"}
    reach = {"sphere": (0.1,) * 3, "capsule": (0.1, 0.1, 0.3), "cylinder": (0.1, 0.1, 0.2)}
    geoms = "".join(f'<body><geom type="{kind}" size="{size}"/></body>' for kind, size in sizes.items())
    joint = '<body><joint name="j"/><geom type="box" size=".1 .1 .1"/></body><geom type="plane" size="1 1 1"/>'
    (tmp_path / "all.xml").write_text(f"<mujoco><worldbody>{geoms}{joint}</worldbody></mujoco>")
    still = np.zeros(2)
    bodies = robot_drawing(RobotAlong(tmp_path / "all.xml", "j", 1.0, np.arange(2.0), {"j": still})).bodies
    assert bodies[0].shapes == ()  # the ground has no end
    for body, kind in zip(bodies[1:], sizes, strict=False):
        (one,) = body.shapes
        np.testing.assert_allclose(np.abs(corners(one)).max(axis=0), reach.get(kind, (0.1, 0.2, 0.3)), rtol=0.1)


def test_a_robot_without_shapes_is_drawn_as_rods_along_its_links(tmp_path):
    (tmp_path / "bare.xml").write_text(MJCF)
    poses = {"shoulder": np.zeros(2), "elbow": np.zeros(2)}
    bodies = robot_drawing(RobotAlong(tmp_path / "bare.xml", "elbow", 1.0, np.arange(2.0), poses)).bodies
    assert bodies[0].shapes == ()
    lowest = [min(corners(one)[:, 2].min() for one in body.shapes) for body in bodies[1:]]
    np.testing.assert_allclose(lowest, [-L1, -C2], rtol=1e-6)


def test_a_robot_of_meshes_stays_small(arm):
    robot = RobotAlong(arm, "elbow", 1.0, np.arange(9.0), {"shoulder": np.zeros(9), "elbow": np.zeros(9)})
    page = view(shown(), arm, "run", robot=robot).sections[0].blocks[0]
    shapes = [one for body in page.robot.bodies for one in body.shapes]
    assert 100 < sum(unpacked(one.faces)[0].size // 3 for one in shapes) <= BUDGET
    assert 10_000 < len(page.robot.model_dump_json()) < 100_000


#: Middles of what is of one colour, red for 0 and blue for 1, in a copy that is made to be read.
CENTRES = """(colours) => { const canvas = document.querySelector("canvas");
  const copy = new OffscreenCanvas(canvas.width, canvas.height);
  const pen = copy.getContext("2d", { willReadFrequently: true });
  pen.drawImage(canvas, 0, 0);
  const { data, width, height } = pen.getImageData(0, 0, canvas.width, canvas.height);
  return colours.map((k) => { let n = 0, x = 0, y = 0;
    for (let i = 0; i < width * height; i++) { const more = data[4 * i] - data[4 * i + 2];
      if (data[4 * i + 3] < 200 || (k === 0 ? more : -more) < 60) continue;
      n += 1; x += i % width; y += Math.floor(i / width); }
    return [x / n, y / n]; }); }"""


def test_its_links_stand_in_the_page_where_the_joints_say(arm, opened, tmp_path):
    """Elbow and tip by the angles of both joints, seen from the side and a little from above; one scale for all."""
    (tmp_path / "model.toml").touch()
    times = np.linspace(0.0, 2.0, 201)
    poses = {"shoulder": 0.3 + 0.4 * times, "elbow": 0.0 * times}
    one = shown()
    moved = type(one)(**{**vars(one), "others": {"restarted every 1 s": one.position + 0.2}})
    robot = RobotAlong(arm, "elbow", RATIO, times, poses)
    write_html(tmp_path / "view.html", view(moved, tmp_path / "model.toml", "run", robot=robot))
    page = opened(tmp_path / "view.html", bypass_csp=True)
    page.get_by_label("seen from").fill("0")
    found, expected = [], []
    for instant, ahead in ((0, AHEAD), (700, AHEAD), (700, AHEAD + 0.2), (1500, AHEAD + 0.2)):
        page.locator("[name=run]").select_option(index=int(ahead > 0.1))
        page.get_by_label("time", exact=True).fill(str(instant))
        page.evaluate("document.querySelector('canvas').style.color = 'rgba(0, 0, 0, 0)'")  # without the ghost
        page.get_by_label("seen from").fill("5")
        page.get_by_label("seen from").fill("0")
        time = instant * 1e-3
        shoulder, elbow = 0.3 + 0.4 * time, (SPEED * time + ahead) / RATIO
        along = [-np.array([np.sin(a), np.cos(a)]) for a in (shoulder, shoulder + elbow)]  # x, z, from where it hangs
        ends = L1 * along[0], L1 * along[0] + TIP * along[1]
        (tip_x, tip_y), (elbow_x, elbow_y) = page.evaluate(CENTRES, [0, 1])
        found += [complex(elbow_x, -elbow_y), complex(tip_x, -tip_y)]
        expected += [complex(x, np.cos(TILT) * z) for x, z in ends]
    found, expected = np.array(found), np.array(expected)
    away, wanted = found - found.mean(), expected - expected.mean()
    scale = np.vdot(wanted, away) / np.vdot(wanted, wanted)
    assert abs(scale.imag) < 0.01 * scale.real
    assert np.abs(away - scale.real * wanted).max() < 0.03 * np.abs(away).max()
