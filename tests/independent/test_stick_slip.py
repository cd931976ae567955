"""Exact stick-slip against closed forms: coast-down and stop, throw and return, breakaway, semigroup."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.validation.independent.plant import Plant, distance_weight, move, speed_weight
from tests.independent.axes import PLAIN, run


def _move(w, torque, step, *, forward=0.05, backward=0.08, inertia=1e-3, viscous=7e-4):
    a = np.array
    rate = a([viscous / inertia])
    weights = speed_weight(rate, a([step])), distance_weight(rate, a([step]))
    after, way = move(a([w]), a([torque]), a([forward]), a([backward]), a([inertia]), rate, weights, step)
    return float(after[0]), float(way[0])


@pytest.mark.parametrize("viscous", [0.0, 1e-7, 8e-4, 0.05])
def test_coast_down_stops_at_the_exact_time_and_angle(viscous, capsys):
    axis, start = replace(PLAIN, viscous=viscous), 10.0
    j, k, c = axis.inertia, viscous, axis.coulomb
    if viscous == 0.0:
        stop, way = j * start / c, j * start**2 / (2 * c)
    else:
        stop = j / k * np.log1p(k * start / c)
        way = j / k * (start - c / k * np.log1p(k * start / c))
    states = run(Plant([axis], [[]], velocity=start), 0.0, 1.02 * stop)
    t = states["time"]
    exact = start - c / j * t if k == 0.0 else (start + c / k) * np.exp(-k / j * t) - c / k
    exact = np.where(t < stop, exact, 0.0)
    worst = np.abs(states["velocity"][:, 0] - exact).max()
    # the closed form itself loses digits as c/k grows
    allowed = 1e-12 * (1.0 + (c / k if k else 0.0))
    with capsys.disabled():
        print(f"\ncoast-down, K_w {viscous:g}: worst speed error {worst:.1e} rad/s, stop after {stop:.4f} s")
    assert worst < allowed * 100
    assert states["velocity"][-1, 0] == 0.0
    assert states["position"][-1, 0] == pytest.approx(way, rel=1e-6 if k == 1e-7 else 1e-10)


@settings(deadline=None, max_examples=80)
@given(
    w=st.floats(-3, 3),
    torque=st.floats(-0.4, 0.4),
    viscous=st.sampled_from([0.0, 1e-6, 7e-4, 0.1]),
    parts=st.integers(2, 7),
)
def test_one_long_step_equals_many_short_ones(w, torque, viscous, parts):
    step = 0.02
    whole = _move(w, torque, step, viscous=viscous)
    speed, way = w, 0.0
    for _ in range(parts):
        speed, gone = _move(speed, torque, step / parts, viscous=viscous)
        way += gone
    assert speed == pytest.approx(whole[0], abs=1e-9)
    assert way == pytest.approx(whole[1], abs=1e-10)


@pytest.mark.parametrize(("torque", "moves"), [(0.049, 0), (0.051, 1), (-0.079, 0), (-0.081, -1), (0.0, 0)])
def test_a_body_at_rest_breaks_away_only_beyond_the_level_of_its_direction(torque, moves):
    after, _ = _move(0.0, torque, 1e-3)
    assert np.sign(after) == moves
    arrived, _ = _move(1e-3 * np.sign(torque), torque, 0.1)
    assert np.sign(arrived) == moves
    if moves == 0:
        assert after == arrived == 0.0


def test_a_throw_against_a_torque_turns_and_returns():
    j, forward, backward, torque, w = 1e-3, 0.05, 0.08, -0.3, 2.0
    turn = w * j / (forward - torque)
    after, way = _move(w, torque, 0.03, inertia=j, viscous=0.0)
    down = (torque + backward) / j
    assert after == pytest.approx(down * (0.03 - turn), rel=1e-12)
    assert way == pytest.approx(w * turn / 2 + down * (0.03 - turn) ** 2 / 2, rel=1e-12)


def test_it_holds_for_ever_below_breakaway_and_leaves_at_the_right_time():
    # torque ramps up by 1 N*m/s and passes the level of 0.06 N*m at 60 ms
    states = run(Plant([PLAIN], [[]]), lambda t: t / PLAIN.torque_constant, 0.1)
    rest = states["time"] <= 0.06
    assert (states["velocity"][rest] == 0.0).all()
    late = states["time"][~rest] - 0.06
    k, j = PLAIN.viscous, PLAIN.inertia
    exact = late / k - j / k**2 * -np.expm1(-k / j * late)
    assert np.abs(states["velocity"][~rest, 0] - exact).max() < 1e-6
