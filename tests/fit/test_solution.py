"""Least squares: within bounds, their covariance and reach, and from which share on a quantity is determined."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from scipy.signal import lfilter

from bench.axis_kind import COULOMB, INERTIA, OFFSET, ROTARY, VISCOUS
from bench.errors import UndeterminedError
from bench.fit.determined import left_open, require_inertia
from bench.fit.hypothesis import BASE
from bench.fit.solution import NormalEquations, bounded, estimated, left_out, long_run_covariance, misfit, solved


@pytest.mark.parametrize("correlated", [0.0, 0.9, 0.99])
def test_least_squares_within_bounds_is_that_of_a_general_solver(correlated):
    """Strongly correlated columns, where a bound that binds at first has to be released later."""
    rng, held = np.random.default_rng(1), 0
    for _ in range(250):
        size = int(rng.integers(2, 8))
        columns = rng.normal(size=(40, size)) * (1.0 - correlated) + correlated * rng.normal(size=(40, 1))
        columns *= 10.0 ** rng.uniform(-3.0, 3.0, size)
        effort = columns @ (rng.normal(size=size) / np.linalg.norm(columns, axis=0)) + rng.normal(scale=0.1, size=40)
        places = rng.permutation(size)[: int(rng.integers(1, size + 1))].tolist()
        scale = 1.0 / np.linalg.norm(columns, axis=0)
        limits = np.sort(rng.normal(size=(size, 2)), axis=1) * scale[:, None]
        low, high = np.full(size, -np.inf), np.full(size, np.inf)
        low[places], high[places] = limits[places].T
        gram, noise = columns.T @ columns, np.zeros((size, size))
        bounds = dict(zip(places, zip(low[places].tolist(), high[places].tolist(), strict=True), strict=True))
        theta, at = bounded(gram, columns.T @ effort, noise, bounds)
        best = lsq_linear(columns * scale, effort, (low / scale, high / scale), method="bvls", tol=1e-14)
        assert (theta >= low).all() and (theta <= high).all()
        assert np.sum((effort - columns @ theta) ** 2) <= 2.0 * best.cost * (1.0 + 1e-9)
        assert all(theta[place] in bounds[place] for place in at)
        held += bool(at)
    assert held > 100


def test_a_column_whose_squares_underflow_explains_nothing():
    columns = np.random.default_rng(0).standard_normal((100, 2)) * [1.0, 1e-160]
    effort = 3.0 * columns[:, 0]
    theta, _ = solved(columns.T @ columns, columns.T @ effort, np.zeros((2, 2)))
    assert theta == pytest.approx([3.0, 0.0])


#: 97.5 % quantile of Student's t by degrees of freedom, from a printed table.
STUDENT = {1: 12.7062, 3: 3.18245, 7: 2.36462, 10: 2.22814, 26: 2.05553}


def impulse(count, place=5, height=3.0):
    """Scores of blocks (count, 1) of which one differs from zero: all their covariances but that at lag 0 vanish."""
    scores = np.zeros((count, 1))
    scores[place] = height
    return scores


@pytest.mark.parametrize(("count", "degrees"), [(14, 10), (30, 26), (5, 1), (4, 1)])
def test_independent_blocks_give_their_squares_and_students_reach_at_as_many_degrees(count, degrees):
    """Four of the degrees go to the plain axis' columns: S = sum of squares*count/(count - 4)."""
    inverse = np.array([[0.5]])
    covariance, reach = estimated(impulse(count, 2), inverse, least=0.0)
    assert covariance[0, 0] == pytest.approx(0.5 * 9.0 * 0.5 * count / degrees)
    assert reach == pytest.approx(STUDENT[degrees], rel=1e-5)


def test_an_interval_is_never_narrower_than_white_noise_alone_makes_it():
    inverse = np.diag([4.0, 1.0])
    scores = np.column_stack([impulse(14)[:, 0], impulse(14, 9)[:, 0]])
    floor = 100.0  # between 4*9*4*1.4 = 201.6 over 4 and 9*1.4 = 12.6 over 1
    covariance, _ = estimated(scores, inverse, least=floor)
    assert np.diag(covariance) == pytest.approx([400.0, 100.0])
    covariance, _ = estimated(scores, inverse, least=20.0)
    assert np.diag(covariance) == pytest.approx([201.6, 20.0])


def test_a_coefficient_that_no_block_pulls_at_has_no_variance_and_no_overflow():
    covariance, _ = estimated(np.zeros((14, 1)), np.array([[1e5]]), least=1e5)
    assert covariance[0, 0] == 0.0


def test_the_long_run_covariance_of_two_neighbours_weighs_them_by_the_kernel():
    """S = a**2 + b**2 + 2*k(1/bandwidth)*a*b, k the quadratic spectral kernel."""
    scores = np.zeros((40, 1))
    scores[10], scores[11] = 2.0, 1.0
    found, bandwidth = long_run_covariance(scores)
    rho = 2.0 / 5.0
    ratio = 4.0 * rho**2 / (1.0 - rho) ** 4
    assert bandwidth == pytest.approx(1.5 * 1.3221 * (ratio * 40) ** 0.2)
    angle = 6.0 * np.pi / 5.0 / bandwidth
    kernel = 3.0 / angle**2 * (np.sin(angle) / angle - np.cos(angle))
    assert found[0, 0] == pytest.approx(5.0 + 2.0 * kernel * 2.0, rel=1e-9)


def rows(count=963, seed=0):
    """Accelerations and speeds of one size each, apart from what orders them, and a residual."""
    rng = np.random.default_rng(seed)
    sizes = 1.0 + 1e-9 * rng.permuted(np.tile(np.arange(count), (2, 1)), axis=1)
    columns = np.sign(rng.normal(size=(count, 2))) * sizes.T
    return columns, rng.normal(size=count)


def jackknife(columns, residual, order, count):
    """Reach by fits without each of `count` equal parts of the rows in an order."""
    moved = []
    for part in np.split(order, np.arange(1, count) * order.size // count):
        kept = np.setdiff1d(order, part)
        moved.append(np.linalg.lstsq(columns[kept], residual[kept], rcond=None)[0])
    return STUDENT[count - 1] * np.sqrt((count - 1) / count * np.sum(np.square(moved), axis=0))


@pytest.mark.parametrize("seed", range(3))
def test_what_is_left_out_is_what_fits_without_each_part_of_the_rows_say(seed):
    columns, residual = rows(seed=seed)
    residual = residual - columns @ np.linalg.lstsq(columns, residual, rcond=None)[0]
    by_state = [jackknife(columns, residual, np.argsort(np.abs(columns[:, k])), 8) for k in (0, 1)]
    by_time = jackknife(columns, residual, np.arange(residual.size), 4)
    expected = np.max([*by_state, by_time], axis=0)
    assert left_out(columns, residual) == pytest.approx(expected, rel=1e-4)


def test_a_coefficient_that_one_part_alone_shows_is_held_however_columns_are_combined():
    """What decays within the first fifth of a recording, next to a constant or joined with it: one reach."""
    columns, residual = rows()
    decays = np.exp(-40.0 * np.arange(residual.size) / residual.size)[:, None]
    constant = np.ones_like(decays)
    alone, joined = (
        left_out(np.hstack([columns[:, :2], constant, each]), residual) for each in (decays, constant + decays)
    )
    assert joined[3] == pytest.approx(alone[3], rel=0.3)


def test_a_misfit_counts_from_1_12_floors_on_by_what_stands_above_them():
    columns, residual = rows()
    residual = residual / np.sqrt(np.mean(residual**2))
    whole = left_out(columns, residual)
    assert not misfit(columns, residual, 1.0 / 1.11).any()
    assert misfit(columns, residual, 1.0 / 1.13) == pytest.approx(np.sqrt(1.0 - (1.12 / 1.13) ** 2) * whole)
    assert misfit(columns, residual, 0.0) == pytest.approx(whole)


@pytest.mark.parametrize("correlation", [0.0, 0.6])
def test_intervals_of_means_cover(correlation):
    """Of 1000 first-order sequences of 200 blocks 95 % of the intervals hold the mean; were they 20 % narrower, 88 %
    would (2*Phi(0.8*1.96) - 1): nine standard deviations of chance less.
    """
    rng, count, held = np.random.default_rng(1), 200, []
    noise = lfilter([1.0], [1.0, -correlation], rng.normal(size=(1000, count + 50)))[:, 50:]
    for sequence in noise:
        mean = sequence.mean()
        covariance, reach = estimated((sequence - mean)[:, None], np.array([[1.0 / count]]), 0.0)
        held.append(abs(mean) <= reach * np.sqrt(covariance[0, 0]))
    print(f"\ncoverage of a mean at correlation {correlation}: {np.mean(held):.3f}")
    assert abs(np.mean(held) - 0.95) < 3.0 * np.sqrt(0.95 * 0.05 / 1000)


NAMES = (*BASE, OFFSET)
PLACES = len(NAMES)


def equations(gram, rows=1000, noise=None):
    """Normal equations of one block: `gram` (5, 5) a row."""
    whole = np.asarray(gram, dtype=float)[None] * rows
    none = np.zeros((PLACES, PLACES))
    return NormalEquations(
        NAMES, whole, np.zeros((1, PLACES)), np.ones(1), np.array([rows]), none if noise is None else noise
    )


def alike(first, second, share):
    """Columns of unit power, of which two share all but `share` of their power, and the direction is even."""
    gram = np.eye(PLACES)
    gram[first, second] = gram[second, first] = np.sqrt(1.0 - share)
    return gram


@pytest.mark.parametrize("share", [0.5, 0.02, 0.008])
def test_the_share_is_what_the_others_do_not_explain(share):
    assert equations(alike(0, 1, share)).independent_shares((INERTIA, VISCOUS))[0] == pytest.approx(share)


def test_noise_of_a_column_is_no_share_of_it():
    noise = np.diag([0.75, 0.0, 0.0, 0.0, 0.0])
    assert equations(np.eye(PLACES), noise=noise).independent_shares((INERTIA, VISCOUS))[0] == pytest.approx(0.25)


@pytest.mark.parametrize(("share", "sure"), [(0.0105, True), (0.0095, False)])
def test_a_quantity_needs_one_per_cent_of_its_own(share, sure):
    found = equations(alike(0, 1, share))
    assert left_open(found, ROTARY) == (frozenset() if sure else {INERTIA, VISCOUS, COULOMB, OFFSET})
    friction = equations(alike(1, 2, share))
    assert left_open(friction, ROTARY) == (frozenset() if sure else {VISCOUS, COULOMB})


def test_what_is_not_shown_has_its_plain_reason_first():
    with pytest.raises(UndeterminedError, match=r": it hardly accelerates: only 0\.9\d? % of what would show it"):
        require_inertia(equations(alike(0, 1, 0.009)), ROTARY)


def test_noise_is_the_reason_where_it_alone_hides_the_acceleration():
    noise = np.diag([1.0, 0.0, 0.0, 0.0, 0.0])
    with pytest.raises(UndeterminedError, match=r"100 % of the measured acceleration's power is noise") as refused:
        require_inertia(equations(np.eye(PLACES), noise=noise), ROTARY)
    assert "hardly accelerates" not in str(refused.value) and "finer" in refused.value.record


@pytest.mark.parametrize(("rows", "sure"), [(100, True), (99, False)])
def test_it_takes_twenty_rows_a_column(rows, sure):
    found = equations(np.eye(PLACES), rows=rows)
    if sure:
        require_inertia(found, ROTARY)
    else:
        with pytest.raises(UndeterminedError, match=r"only 99 filtered samples .* 100 are needed"):
            require_inertia(found, ROTARY)


@pytest.mark.parametrize(
    ("weaker", "side"), [(0.021, None), (0.019, "forward"), (0.981, "backward"), (0.979, None), (0.5, None)]
)
def test_one_way_is_less_than_two_per_cent_the_other_way(weaker, side):
    gram = np.eye(PLACES)
    gram[2, 4] = gram[4, 2] = 1.0 - 2.0 * weaker
    assert equations(gram).one_way == side
