"""What the MJCF does not contain of the links, over all joints together: a payload, or a link's inertia that it has
wrong.

The joint torque of a point of mass on a body is linear in the mass and quadratic in its place; what more inertia of
a link about its joint's axis causes is linear in that. Each is a column of every joint's torque balance with the
joint's own inertia and friction, and its strength is common to all:

    M_j = J_j*alpha_j + K_wj*omega_j + f_j*sgn(omega_j) + sum over k of s_k*C_jk
    f_j = K_0j + mu_j*|M_known,j| + sum over l of a_jl*exp(-(omega_j/w_l)**2)

C_jk - known torque of the robot with the change less that without, per unit of it. Joints weigh by what they leave. The
covariance is that of scores summed over stretches of time, in which residuals are correlated (K.-Y. Liang, S. L. Zeger,
Biometrika 73, 1986, 13-22). A link turns its own joint as an armature does: other joints determine its inertia, if any
do.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, special

from bench.arrays import Array, symmetric_inverse
from bench.errors import BenchError, UndeterminedError
from bench.fit.rows import Rows
from bench.joints.identified import JointLogs, of_each
from bench.joints.weight import LEAST, OWN, own_columns
from bench.parameter import Parameter
from bench.plant.robot import AddedBody, Change, Counting, joint_rig, logs_of

#: Stretches that the rows of a log are cut into, equally many in each.
STRETCHES = 24
#: Rounds in which weights of the joints, and the place of a payload, settle.
ROUNDS = 3
#: Distance between places of masses - m.
ASIDE = 0.1
#: Share of the strongest column's power at which another has none.
SILENT = 1e-9
#: A link's inertia is doubted where this many errors and this share of all joints' residuals require it.
SURE, TAKES = 6.0, 0.2
#: Links and zeros at most that are doubted.
MOST = 3
#: Step of a zero - rad (m) -, and logarithm by which the squares of two joints at least have to fall for it.
SHIFT, SEVERAL = 1e-3, 0.7
#: Share of a joint's squares that remain where it may be counted the other way; logarithm by which all have to fall.
UNLIKE, TURNED = 0.1, 2.0


@dataclass(frozen=True)
class FoundPayload:
    """A mass that a body carried: kg, and its centre in the body's frame - m -, as a point."""

    body: str
    mass: Parameter
    centre: tuple[Parameter, Parameter, Parameter]

    @property
    def added(self) -> AddedBody:
        """As the robot has it."""
        x, y, z = (one.value for one in self.centre)
        return AddedBody(self.body, self.mass.value, (x, y, z))


@dataclass(frozen=True)
class Common:
    """Strengths (k,) common to all joints.

    Attributes:
        strengths, deviations: those and their standard errors (k,).
        reach: of an interval of 95 % in standard errors.
        lefts: logarithms of the joints' squared residuals (j,).
        open: which strengths no joint shows (k,).
    """

    strengths: Array
    deviations: Array
    reach: float
    lefts: Array
    open: NDArray[np.bool_]

    @property
    def left(self) -> float:
        """Their sum."""
        return float(self.lefts.sum())

    def parameter(self, value: float, deviation: float, unit: str) -> Parameter:
        """A value with its interval."""
        return Parameter.around(float(value), unit, float(deviation), float(self.reach * deviation))


def gathered(asked: JointLogs, changes: Sequence[Change]) -> Array | None:
    """Products of a joint's own columns, those of changes of the robot, and its effort, by stretch (s, n, n).

    None of a joint that the logs do not determine.
    """
    found = []
    for log in asked.logs:
        try:
            robot, rig = asked.robot_of(log), joint_rig(asked.rig, asked.robot())
            (trace, *changed), _ = logs_of(log, rig, robot, asked.stated, changes)
            rows = Rows.of(trace, rig)
            columns = [own_columns(rows)]
            columns += [rows.effort - Rows.of(one, rig, conditioning=rows.conditioning).effort for one in changed]
        except BenchError:  # reported where the joint is identified
            continue
        table = np.column_stack([*columns, rows.effort])
        found += [part.T @ part for part in np.array_split(table, STRETCHES)]
    return np.array(found) if found else None


def of_joints(
    work: Sequence[JointLogs], changes: Sequence[Change], progress: Callable[[float], None] = lambda share: None
) -> list[Array]:
    """Those products of all joints that the logs determine, each on a process."""
    every = of_each(partial(gathered, changes=tuple(changes)), work, progress)
    return [one for one in every if isinstance(one, np.ndarray)]


def shared(products: Sequence[Array], chosen: Sequence[int] | Array) -> Common:
    """Strengths of columns: of some of them by their number, or of combinations of all (all, k)."""
    every = products[0].shape[1] - OWN - 1
    mix = np.asarray(chosen, dtype=float) if np.ndim(chosen) == 2 else np.eye(every)[:, list(chosen)]
    turn = np.array(linalg.block_diag(np.eye(OWN), mix, 1.0), dtype=np.float64)
    parts = [turn.T @ each @ turn for each in products]
    reduced = np.array([_reduced(part.sum(axis=0)) for part in parts])
    lefts = [float(each[-1, -1]) for each in reduced]
    for _ in range(ROUNDS - 1):
        strengths, _, _ = _solved(reduced, lefts)
        lefts = [_scores(part, strengths)[1] for part in parts]
    strengths, inverse, weights = _solved(reduced, lefts)
    scores, lefts = zip(*(_scores(part, strengths) for part in parts), strict=True)
    stretches = max(len(part) for part in parts)
    summed = np.zeros((stretches, strengths.size))
    for score, weight in zip(scores, weights, strict=True):
        summed[: len(score)] += weight * score
    degrees = max(stretches - strengths.size - 1, 1)
    covariance = inverse @ (summed.T @ summed) @ inverse * stretches / degrees
    power = np.einsum("jkk->k", reduced[:, :-1, :-1])
    silent = power <= SILENT * power.max()
    reach = float(special.stdtrit(degrees, 0.975))
    return Common(strengths, np.sqrt(np.diag(covariance)), reach, np.log(lefts), silent)


def _solved(reduced: Array, lefts: Sequence[float]) -> tuple[Array, Array, Array]:
    """Strengths (k,), the inverse of their matrix (k, k), and weights of the joints, by the residual of each (j,)."""
    weights = 1.0 / np.maximum(lefts, 1e-300)
    inverse = symmetric_inverse(np.tensordot(weights, reduced[:, :-1, :-1], 1)[None], 1e-12)[0]
    return inverse @ np.tensordot(weights, reduced[:, :-1, -1], 1), inverse, weights


def _reduced(product: Array) -> Array:
    """Products of the other columns and the effort, beyond what a joint's own columns explain."""
    beside = product[:OWN, OWN:]
    return product[OWN:, OWN:] - beside.T @ np.linalg.lstsq(product[:OWN, :OWN], beside, rcond=1e-12)[0]


def _scores(part: Array, strengths: Array) -> tuple[Array, float]:
    """Scores of the strengths by stretch (s, k) of a joint, and its residual sum of squares."""
    whole = part.sum(axis=0)
    projection = np.linalg.lstsq(whole[:OWN, :OWN], whole[:OWN, OWN:], rcond=1e-12)[0]
    theta = projection[:, -1] - projection[:, :-1] @ strengths
    away = np.concatenate([-theta, -strengths, [1.0]])
    felt = part @ away
    scores = felt[:, OWN:-1] - felt[:, :OWN] @ projection[:, :-1]
    return scores, float(away @ whole @ away)


def seek_payload(work: Sequence[JointLogs], body: str, progress: Callable[[float], None]) -> FoundPayload:
    """Mass and centre of what a body carries, by gravity and acceleration over all joints together.

    UndeterminedError where the logs do not determine a mass above zero, InputError where the MJCF has no such body.
    """
    replace(work[0], added=(AddedBody(body),)).robot()
    products = of_joints(work, [AddedBody(body, 1.0, (x, y, z)) for x, y, z in PLACES.tolist()], progress)
    if not products:
        raise UndeterminedError(f"the payload of '{body}'", "no joint is determined by the logs", "a log of all joints")
    mix, found, mass, centre = _carried(products, body, np.zeros(3))
    for _ in range(ROUNDS - 1):
        mix, found, mass, centre = _carried(products, body, centre)
    errors = np.where(found.open[1:], np.inf, found.deviations[1:] / mass.value)
    moved = _without_each(products, mix, found.strengths) / np.array([1.0, *[mass.value] * 3])
    coordinates = zip(centre, errors, moved[1:], strict=True)
    x, y, z = (found.parameter(value, error, "m").widened(by) for value, error, by in coordinates)
    return FoundPayload(body, mass.widened(moved[0]), (x, y, z))


def _carried(products: Sequence[Array], body: str, near: Array) -> tuple[Array, Common, Parameter, Array]:
    """What a body carries, sought near a place (3,): how that is mixed of PLACES, strengths, mass and centre (3,)."""
    mix = _at(near)
    found = shared(products, mix)
    mass = found.parameter(found.strengths[0], found.deviations[0], "kg")
    if mass.ci95[0] <= 0.0:
        reason = f"its mass comes out as {mass.value:.3g} ± {mass.half_width:.2g} kg"
        raise UndeterminedError(f"the payload of '{body}'", reason, "a log in which the body is lifted and turned")
    return mix, found, mass, near + found.strengths[1:] / mass.value


def _monomials(x: Array, y: Array, z: Array) -> Array:
    """Of places (n,), those of which the torque of a point of mass is a combination (n, 10)."""
    return np.stack([x**0, x, y, z, x * x, y * y, z * z, x * y, x * z, y * z], axis=-1)


#: Places that together determine the torque of a point of mass at any other - m.
PLACES = ASIDE * np.array(
    [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0), (0, 0, -1), (1, 1, 0), (1, 0, 1), (0, 1, 1)]
)


def _at(centre: Array) -> Array:
    """What a mass at a place, and its moments about it, are in masses at PLACES (10, 4)."""
    (x, y, z), zero, one = centre, 0.0, 1.0
    slopes = [
        (zero, one, zero, zero, 2 * x, zero, zero, y, z, zero),
        (zero, zero, one, zero, zero, 2 * y, zero, x, zero, z),
        (zero, zero, zero, one, zero, zero, 2 * z, zero, x, y),
    ]
    own = np.array([_monomials(x, y, z), *slopes])
    return np.linalg.inv(_monomials(*PLACES.T).T) @ own.T


def _without_each(products: Sequence[Array], mix: Array, strengths: Array) -> Array:
    """How far strengths (k,) move at most where a joint is left out, whose own misfit they may have taken."""
    others = [
        shared([*products[:k], *products[k + 1 :]], mix).strengths for k in range(len(products) if products[1:] else 0)
    ]
    return np.max(np.abs(np.array([strengths, *others]) - strengths), axis=0)


def doubt_links(work: Sequence[JointLogs]) -> dict[Change, Parameter]:
    """Inertias of links and zeros of joints of the MJCF that the logs contradict, the clearest first.

    Each as the change that it takes, with the inertia over the MJCF's, or the zero - rad (m).
    """
    names = [asked.joint for asked in work]
    inertias: list[Change] = [AddedBody(joint=name, inertia=1.0) for name in names]
    zeros: list[Change] = [Counting(name, SHIFT) for name in names]
    products = of_joints(work, [*inertias, *zeros])
    if len(products) < 2:
        return {}
    chosen = _contradicted(products, [asked.robot().link_inertia for asked in work])
    if not chosen:
        return {}
    found, doubts = shared(products, chosen), dict[Change, Parameter]()
    for k, more, deviation in zip(chosen, found.strengths, found.deviations, strict=True):
        name = names[k % len(names)]
        if k < len(names):
            own = work[k].robot().link_inertia
            factor = found.parameter(1.0 + more / own, deviation / own, "dimensionless")
            doubts[AddedBody(joint=name, inertia=float(more))] = factor
        else:
            zero = found.parameter(SHIFT * more, SHIFT * deviation, work[0].robot().unit(name))
            doubts[Counting(name, zero.value)] = zero
    return doubts


def _contradicted(products: Sequence[Array], own: Sequence[float]) -> list[int]:
    """Numbers of the columns that the residuals of all joints require: of links' inertias, and then of zeros.

    A zero turns all links that follow: it has to explain residuals of more than one joint. An unbalance is of one.
    """
    links, every = len(own), products[0].shape[1] - OWN - 1
    determined = [k for k in range(every) if _tells(products, k)]
    chosen: list[int] = []
    lefts = np.array([np.log(_scores(_only(one, []), np.zeros(0))[1]) for one in products])
    while len(chosen) < MOST:
        tried = {k: shared(products, [*chosen, k]) for k in determined if k not in chosen}
        # a link whose inertia would be negative explains something else that is missing
        tried = {
            k: one
            for k, one in tried.items()
            if (one.strengths[-1] > -own[k] if k < links else np.sum(lefts - one.lefts > SEVERAL) > 1)
        }
        best = min(tried, key=lambda k: tried[k].left, default=None)
        if best is None or float(lefts.sum()) - tried[best].left < TAKES:
            break
        found = tried[best]
        if np.abs(found.strengths[-1]) < SURE * found.deviations[-1]:
            break
        chosen, lefts = [*chosen, best], found.lefts
    return chosen


def reversed_joints(work: Sequence[JointLogs]) -> list[Counting]:
    """Joints that the first log counts the other way than the MJCF: the residuals of all fall if they are turned."""
    first = [replace(asked, logs=asked.logs[:1]) for asked in work]
    found, left, unlike = list[Counting](), *_left(first)
    while unlike and len(found) < len(work):
        known = {one.joint for one in found}
        more = [Counting(asked.joint, reversed=True) for asked in work if asked.joint not in known]
        tried = {one: _left(carrying(first, [*found, one])) for one in more}
        best = min(tried, key=lambda one: tried[one][0])
        if left - tried[best][0] < TURNED:
            break
        found, (left, unlike) = [*found, best], tried[best]
    return found


def _left(work: Sequence[JointLogs]) -> tuple[float, bool]:
    """Logarithms of the squared residuals of all joints, summed, and whether one of them is large."""
    wholes = [_only(one, []).sum(axis=0) for one in of_joints(work, [])]
    lefts = [float(_reduced(whole)[0, 0]) for whole in wholes]
    unlike = any(left > UNLIKE * whole[-1, -1] for left, whole in zip(lefts, wholes, strict=True))
    return float(np.log(np.maximum(lefts, 1e-300)).sum()), unlike


def doubted(work: Sequence[JointLogs]) -> tuple[list[JointLogs], dict[str, Parameter], dict[str, Parameter]]:
    """The logs of the robot as they show it, and links' inertias over the MJCF's and zeros - rad (m) - by joint.

    Zeros settle first, as they turn the links.
    """
    shown, at, links, zeros = list(work), dict[str, float](), dict[AddedBody, Parameter](), dict[str, Parameter]()
    for _ in range(MOST):
        doubts = doubt_links(shown)
        links = {one: factor for one, factor in doubts.items() if isinstance(one, AddedBody)}
        steps = {one.joint: one.zero for one in doubts if isinstance(one, Counting)}
        if not steps:
            break
        for _ in range(ROUNDS):
            at = {joint: at.get(joint, 0.0) + steps.get(joint, 0.0) for joint in {**at, **steps}}
            shown = carrying(work, [Counting(joint, zero) for joint, zero in at.items()])
            found = shared(of_joints(shown, [Counting(joint, SHIFT) for joint in at]), range(len(at)))
            steps = dict(zip(at, (SHIFT * found.strengths).tolist(), strict=True))
            units = {joint: shown[0].robot().unit(joint) for joint in at}
            values = zip(at, (SHIFT * found.deviations).tolist(), strict=True)
            zeros = {j: found.parameter(at[j] + steps[j], error, units[j]) for j, error in values}
    changes = [*(Counting(joint, zero.value) for joint, zero in zeros.items()), *links]
    return carrying(work, changes), {one.joint: factor for one, factor in links.items()}, zeros


def _only(product: Array, kept: Sequence[int]) -> Array:
    """Products of a joint's own columns, some of the others and the effort."""
    places = [*range(OWN), *(OWN + k for k in kept), product.shape[1] - 1]
    return product[:, places][:, :, places]


def _tells(products: Sequence[Array], k: int) -> bool:
    """Whether any joint shows a column distinct from its own terms."""
    wholes = (_only(product, [k]).sum(axis=0) for product in products)
    return any(whole[-2, -2] > 0.0 and _reduced(whole)[0, 0] > LEAST * whole[-2, -2] for whole in wholes)


def carrying(work: Sequence[JointLogs], added: Sequence[Change]) -> list[JointLogs]:
    """The same logs of a robot with changes."""
    return [replace(asked, added=(*asked.added, *added)) for asked in work]
