"""A robot as a page draws it: bodies with triangles in few bytes, and the joints by which each moves its own.

A mesh is simplified by vertices that fall into one cell of a grid (J. Rossignac, P. Borrel, "Multi-resolution 3D
approximations for rendering complex scenes", 1993), as coarse as the number of triangles requires.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.plant.mjcf_file import read_spec
from bench.report import document as doc
from bench.report.over_time import in_steps
from bench.view.side_by_side import RobotAlong

#: Triangles of a whole robot, 6 to 7 bytes each with its vertices: some 20 kB of a page.
BUDGET = 3000
#: Triangles that every shape may have.
LEAST = 24
#: Corners of a round shape about its axis, and of its profile.
AROUND, ALONG = 12, 5
#: Cells along a mesh at first, and by how much fewer they become.
CELLS, FEWER = 96, 0.85
#: Groups of geoms that MuJoCo shows by itself.
SHOWN = 3
#: Radius of a rod, as a share of the longest, and its colour.
THICK, GREY = 0.04, (0.5, 0.5, 0.5)
#: Instants at most at which joints are counted that only pass by.
INSTANTS = 1000
#: Triangles by three of its vertices each (t, 3).
Faces = NDArray[np.int64]
#: A box by its corners in binary order.
BOX = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
     [1, 5, 7], [1, 7, 3]]
)  # fmt: skip


def robot_drawing(robot: RobotAlong) -> doc.RobotDrawing:
    """The robot as a page has it, its joints numbered as their poses are."""
    model = read_spec(str(robot.mjcf))[0].compile()
    even = np.linspace(robot.times[0], robot.times[-1], min(robot.times.size, INSTANTS))
    others = {name: values for name, values in robot.poses.items() if name != robot.joint}
    return doc.RobotDrawing(
        bodies=_bodies(model, [robot.joint, *others]),
        ratio=robot.ratio,
        start=float(even[0]),
        step=float(even[1] - even[0]),
        poses=tuple(in_steps(np.interp(even, robot.times, values)) for values in others.values()),
    )


def _bodies(model: mujoco.MjModel, names: Sequence[str]) -> tuple[doc.Body, ...]:
    """All bodies, whose joints have the numbers of these names."""
    shown = [g for g in range(model.ngeom) if model.geom_group[g] < SHOWN and _colour(model, g)[3] > 0.0]
    solid = {g: found for g in shown if (found := _solid(model, g)) is not None}
    budget = _shared({g: len(faces) for g, (_, faces) in solid.items()})
    shapes: list[list[doc.Triangles]] = [[] for _ in range(model.nbody)] if solid else _rods(model)
    for g, (vertices, faces) in solid.items():
        turn = np.empty(9)
        mujoco.mju_quat2Mat(turn, model.geom_quat[g])
        vertices, faces = simplified(vertices, faces, budget[g])
        placed = vertices @ turn.reshape(3, 3).T + model.geom_pos[g]
        shapes[model.geom_bodyid[g]].append(_triangles(_rounded(_colour(model, g)[:3]), placed, faces))
    return tuple(
        doc.Body(
            parent=int(model.body_parentid[b]),
            place=_rounded(model.body_pos[b]),
            turn=_rounded(model.body_quat[b]),
            joints=tuple(_joints(model, b, names)),
            shapes=tuple(shapes[b]),
        )
        for b in range(model.nbody)
    )


def _rods(model: mujoco.MjModel) -> list[list[doc.Triangles]]:
    """Of a robot without shapes: rods from the origin of each body to those it carries, and to its centre of mass."""
    ends = [[model.body_ipos[b], *model.body_pos[model.body_parentid == b]] for b in range(1, model.nbody)]
    radius = THICK * max((float(np.linalg.norm(end)) for of in ends for end in of), default=0.0)
    shapes: list[list[doc.Triangles]] = [[]]
    for of in ends:
        shapes.append([])
        for end in of:
            length, turn, matrix = float(np.linalg.norm(end)), np.empty(4), np.empty(9)
            if length > radius:
                mujoco.mju_quatZ2Vec(turn, end)
                mujoco.mju_quat2Mat(matrix, turn)
                profile = np.array([[0.0, 0.0], [radius, 0.0], [radius, length], [0.0, length]])
                vertices, faces = _revolved(profile)
                shapes[-1].append(_triangles(GREY, vertices @ matrix.reshape(3, 3).T, faces))
    return shapes


def _triangles(colour: tuple[float, ...], vertices: Array, faces: Faces) -> doc.Triangles:
    corners = doc.Samples(offset=0.0, scale=1.0, low=doc.packed(faces, "<i2"), high=None)
    return doc.Triangles(colour=colour, vertices=in_steps(vertices.T.ravel()), faces=corners)


def _joints(model: mujoco.MjModel, body: int, names: Sequence[str]) -> Iterator[doc.Pivot]:
    first = int(model.body_jntadr[body])
    for k in range(first, first + int(model.body_jntnum[body])):
        slides, name = model.jnt_type[k] == int(mujoco.mjtJoint.mjJNT_SLIDE), model.joint(k).name
        if slides or model.jnt_type[k] == int(mujoco.mjtJoint.mjJNT_HINGE):
            yield doc.Pivot(
                of=names.index(name) if name in names else None,
                axis=_rounded(model.jnt_axis[k]),
                anchor=_rounded(model.jnt_pos[k]),
                slides=slides,
                zero=float(model.qpos0[model.jnt_qposadr[k]]),
            )


def _rounded(values: Iterable[float]) -> tuple[float, ...]:
    """As a page has them: to a hundredth of a millimetre."""
    return tuple(round(float(value), 6) for value in values)


def _colour(model: mujoco.MjModel, geom: int) -> Array:
    material = int(model.geom_matid[geom])
    return model.mat_rgba[material] if material >= 0 else model.geom_rgba[geom]


def _shared(triangles: Mapping[int, int]) -> dict[int, int]:
    """How many of the budget each shape has: the small ones all of theirs, the others as much as each other."""
    left, found = BUDGET, {}
    for count, (g, many) in enumerate(sorted(triangles.items(), key=lambda item: item[1])):
        found[g] = min(many, max(LEAST, left // (len(triangles) - count)))
        left -= found[g]
    return found


def _solid(model: mujoco.MjModel, geom: int) -> tuple[Array, Faces] | None:
    """Vertices and triangles of a geom in its own frame; None of what has no end, and of fields of heights."""
    kinds, size = mujoco.mjtGeom, model.geom_size[geom]
    arc = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 2 * ALONG)
    ball = np.column_stack([np.cos(arc), np.sin(arc)])
    match kinds(int(model.geom_type[geom])):
        case kinds.mjGEOM_MESH:
            mesh = int(model.geom_dataid[geom])
            first, face = int(model.mesh_vertadr[mesh]), int(model.mesh_faceadr[mesh])
            vertices = model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])]
            faces = model.mesh_face[face : face + int(model.mesh_facenum[mesh])]
            return vertices.astype(float), faces.astype(np.int64)
        case kinds.mjGEOM_BOX:
            return np.array([*product((-1.0, 1.0), repeat=3)]) * size, BOX
        case kinds.mjGEOM_SPHERE:
            return _revolved(size[0] * ball)
        case kinds.mjGEOM_ELLIPSOID:
            vertices, faces = _revolved(ball)
            return vertices * size, faces
        case kinds.mjGEOM_CAPSULE:
            return _revolved(size[0] * ball + np.outer(np.sign(ball[:, 1]), [0.0, size[1]]))
        case kinds.mjGEOM_CYLINDER:
            return _revolved(np.array([[0.0, -size[1]], [size[0], -size[1]], [size[0], size[1]], [0.0, size[1]]]))
    return None


def _revolved(profile: Array) -> tuple[Array, Faces]:
    """Of radius and height along a profile (p, 2), from below, turned about z."""
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    radius, height = profile.T
    x, y = (np.outer(part, radius) for part in (np.cos(angle), np.sin(angle)))
    vertices = np.stack([x, y, np.broadcast_to(height, x.shape)], axis=-1).reshape(-1, 3)
    at = np.arange(AROUND)[:, None] * len(profile) + np.arange(len(profile) - 1)
    beside = np.roll(at, -1, axis=0)
    faces = np.stack([at, beside, beside + 1, at, beside + 1, at + 1], axis=-1).reshape(-1, 3)
    return vertices, faces


def simplified(vertices: Array, faces: Faces, most: int) -> tuple[Array, Faces]:
    """A surface of at most so many triangles, by cells as small as that allows."""
    low, reach = vertices.min(axis=0), float(np.ptp(vertices, axis=0).max())
    cells = float(CELLS)
    while True:
        keys = np.floor((vertices - low) / max(reach, 1e-300) * cells).astype(np.int64)
        _, cell, count = np.unique(_packed(keys, CELLS + 1), return_inverse=True, return_counts=True)
        kept = cell[faces]
        kept = kept[(kept[:, 0] != kept[:, 1]) & (kept[:, 1] != kept[:, 2]) & (kept[:, 2] != kept[:, 0])]
        _, first = np.unique(_packed(np.sort(kept, axis=1), count.size), return_index=True)
        if first.size <= most or cells < 2.0:
            break
        cells *= FEWER
    middle = np.column_stack([np.bincount(cell, column) for column in vertices.T])
    return middle / count[:, None], kept[np.sort(first)]


def _packed(triples: NDArray[np.int64], end: int) -> NDArray[np.int64]:
    """One number for each three of 0 to below an end (n, 3), in the same order: NumPy sorts rows in 12 times the time.

    Cells are at most (CELLS + 1)**3, of which three take 60 bits.
    """
    return (triples[:, 0] * end + triples[:, 1]) * end + triples[:, 2]
