"""Columns of a torque balance and what the sensors' noise becomes in it, against closed forms."""

from dataclasses import fields
from functools import cache

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.effect import Columns
from bench.effects.rivals import RIVALS, WAVES
from bench.fit.fit import fit
from bench.fit.hypothesis import BASE, Hypothesis, Term, lay_out, plain
from bench.fit.rows import Rows
from bench.fit.solution import Floor
from bench.fit.stored import Balance
from bench.rig.rig import Rig
from bench.trace.trace import Trace, less_known, with_known
from tests.fit.motions import RIG, recording
from tests.sines import sines

TIME = 1e-3 * np.arange(8000)
SPEED = 20.0 * np.sin(2.0 * np.pi * 0.7 * TIME) + 8.0 * np.sin(2.0 * np.pi * 1.9 * TIME)
ANGLE = np.cumsum(SPEED) * 1e-3
MOTOR = {"torque_constant": "0.5 N*m/A", "resistance": "2 ohm", "back_emf_constant": "0.4 V*s/rad"}
#: A known weight: M = m*g*r*sin(q).
LOAD = {"eccentric_mass": "0.3 kg", "eccentric_radius": "0.1 m"}


@pytest.mark.parametrize("signal", ["voltage", "current"])
def test_the_column_of_the_shift_is_the_rate_of_the_signal_alone(signal):
    values = 3.0 * np.cos(2.0 * np.pi * 1.1 * TIME)
    rig = Rig.of({"name": "axis", "kind": "rotary", "motor": MOTOR, "load": LOAD})
    units = {"time": "s", "velocity": "rad/s", "position": "rad", "voltage": "V", "current": "A"}
    signals = {"time": TIME, "velocity": SPEED, "position": ANGLE, signal: values}
    trace = Trace.from_arrays(signals, {name: units[name] for name in signals})
    rows = Rows.of(trace, rig)
    column = lay_out(rows, plain(rows)).columns[:, BASE.index("misalignment")]
    gain = 0.5 / 2.0 if signal == "voltage" else 0.5
    rate = rows.table(lambda s: [[(np.interp(s.time, TIME, values), 1)]])[:, 0]
    np.testing.assert_allclose(column, -gain * rate, atol=1e-9 * np.abs(rate).max())


PLAIN = Rig.of({"name": "axis", "kind": "rotary"})
J, K_W, K_0 = 2e-3, 1e-3, 0.05


def known(noise=0.0, seed=0, torque_noise=2e-3):
    """An axis beside which r + dp/dt acts, far more than its own torque; the momentum p is known with noise."""
    rng = np.random.default_rng(seed)
    speed, acceleration, _ = sines(TIME, [(20.0, 0.7, 0.0), (20.0, 2.3, 0.0), (20.0, 6.1, 0.0)])
    r, p, rate = 2.0 * np.sin(3.0 * TIME), 0.4 * np.cos(11.0 * TIME), -4.4 * np.sin(11.0 * TIME)
    torque = J * acceleration + K_W * speed + K_0 * np.sign(speed) + r + rate
    signals = {
        "velocity": speed + 2e-3 * rng.standard_normal(TIME.size),
        "torque": torque + torque_noise * rng.standard_normal(TIME.size),
    }
    trace = Trace(TIME, signals, {"velocity": "rad/s", "torque": "N*m"}, "closed form")
    return with_known(trace, r, p + noise * rng.standard_normal(TIME.size), "N*m")


def test_the_rest_is_inertia_and_friction():
    found = fit(Rows.of(known(), PLAIN), Hypothesis())
    np.testing.assert_allclose(found.theta[:3], [J, K_W, K_0], rtol=5e-3)


def test_it_leaves_noise_alone():
    """Loud enough that the jumps of dry friction, which are as fast, do not pass for noise."""
    assert fit(Rows.of(known(torque_noise=5e-2), PLAIN), Hypothesis()).chi == pytest.approx(1.0, abs=0.15)


def test_its_noise_counts_in_the_floor():
    quiet, loud = (fit(Rows.of(known(noise), PLAIN, cutoff=60.0), Hypothesis()) for noise in (0.0, 5e-4))
    assert loud.rms > 3.0 * quiet.rms
    assert loud.chi == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize("name", ["current_filter_lag", "velocity_filter_lag", "current_loop_lag"])
def test_a_lag_that_vanishes_leaves_it_as_it_is(name):
    rows = Rows.of(known(), PLAIN)
    lagging = Hypothesis((Term(catalogue()[name], (1e-12,)),))
    np.testing.assert_allclose(lay_out(rows, lagging).effort, lay_out(rows, Hypothesis()).effort, atol=1e-9)


def test_sample_by_sample_it_is_the_same_to_the_order_of_the_difference():
    trace = known()
    rest = less_known(trace, trace["torque"])
    plain = trace.without("known_torque").without("known_momentum")
    assert less_known(plain, plain["torque"]) is plain["torque"]
    w = trace["velocity"]
    own = J * np.gradient(w, 1e-3) + K_W * w + K_0 * np.sign(w)
    assert np.sqrt(np.mean((rest - own)[5:-5] ** 2)) < 8e-3


@cache
def holed_rows():
    whole = recording(np.random.default_rng(3), position=True)
    kept = (np.arange(len(whole)) % 1811) > 137
    holed = Trace(
        whole.time[kept], {name: whole[name][kept] for name in whole.signals}, dict(whole.units), whole.origin
    )
    rows = Rows.of(holed, RIG)
    assert len(rows.stretches) == 4
    return rows


def test_no_row_reaches_over_a_hole():
    rows = holed_rows()

    def columns(s):
        late = [(s.effort, 1)] if s.time[0] > 2.0 else []  # as an event, which is not in every stretch
        return [[(s.velocity, 1)], [(s.position, 0), (s.velocity, 1), *late]]

    smooth = rows.conditioning.filter
    alone = [smooth.columns(columns(part.signals), (0.0, 1e-3), part.places) for part in rows.stretches]
    assert rows.table(columns, (0.0, 1e-3)) == pytest.approx(np.concatenate(alone, axis=1).T, rel=1e-9, abs=1e-9)


MEMORYLESS = [
    each for each in (*catalogue().values(), *RIVALS, *WAVES) if isinstance(each, Columns) and each.memoryless
]


@pytest.mark.parametrize("effect", MEMORYLESS, ids=lambda effect: effect.name)
def test_columns_without_memory_are_those_of_each_stretch(effect):
    """They are made of all stretches at once, each value from its own sample."""
    rows, shape = holed_rows(), tuple(1.5 for _ in effect.shapes)
    by_stretch = rows.table(lambda signals: effect.columns(signals, shape))
    scale = np.abs(by_stretch).max()
    assert rows.table([rows.columns_of(effect, [shape])]) == pytest.approx(by_stretch, rel=1e-9, abs=1e-12 * scale)


def test_products_with_columns_are_those_of_filtered_ones():
    """Without the columns being filtered, with a derivative, over holes and behind a lag."""
    rows = holed_rows()
    targets = np.random.default_rng(0).normal(size=(rows.time.size, 3))
    (inertia,) = (effect for effect in MEMORYLESS if effect.name == "position_dependent_inertia")
    columns = rows.columns_of(inertia, [(1.0,), (2.0,)])
    filtered = rows.table([columns], 1e-3)
    assert rows.against(targets, 1e-3)(columns) == pytest.approx(filtered.T @ targets, rel=1e-9)


OMEGA = np.array([0.0, 100.0, 400.0])
NONE = np.zeros(3)


def theta_of(layout, **values):
    """Coefficients (p,) of a layout: J, K_w, K_0, misalignment, and the one strength of a term."""
    theta = np.zeros(layout.owners.size)
    for name in BASE:
        theta[layout.owners == name] = values.get(name, 0.0)
    theta[layout.owners == 0] = values.get("strength", 0.0)
    return theta


def power(rows, hypothesis, source, **values):
    layout = lay_out(rows, hypothesis)
    theta = theta_of(layout, **values)
    return Floor(rows, hypothesis, layout, theta, np.zeros_like(layout.effort)).power(OMEGA, source)


def test_noise_of_the_effort_passes_its_misalignment_and_that_of_the_speed_inertia_and_friction():
    rows = Rows.of(recording(np.random.default_rng(0)), RIG)
    effort = rows.conditioning.effort_noise**2
    late = 1.0 + (1e-3 * OMEGA) ** 2
    np.testing.assert_allclose(power(rows, Hypothesis(), NONE, misalignment=1e-3), effort * late)
    moved = power(rows, Hypothesis(), np.full(3, 4.0), inertia=2e-3, viscous=0.3) - effort
    np.testing.assert_allclose(moved, 4.0 * ((2e-3 * OMEGA) ** 2 + 0.3**2))


def test_the_floor_of_a_plain_axis_is_the_filtered_noise_of_both_sensors():
    """s_M**2*G_0**2 + (J*s_w*G_1)**2 + (K_w*s_w*G_0)**2, G_k the filter's gains for white noise."""
    fitted = fit(Rows.of(recording(np.random.default_rng(2), torque_noise=0.02, velocity_noise=0.3), RIG), Hypothesis())
    conditioning, base = fitted.rows.conditioning, fitted.base
    gains = [conditioning.filter.noise_gain(order) for order in (0, 1)]
    parts = (
        conditioning.effort_noise * gains[0],
        base.inertia * conditioning.source_noise * gains[1],
        base.viscous * conditioning.source_noise * gains[0],
    )
    assert fitted.noise.white == pytest.approx(np.sqrt(np.sum(np.square(parts))), rel=2e-3)
    assert parts[1] > 0.3 * parts[0]


@pytest.mark.parametrize("period", [1e-3, 1.0 / 16000.0], ids=["1 kHz", "16 kHz"])
@pytest.mark.parametrize("shape", [(150.0, 0.01), (150.0, 0.3), (600.0, 0.002)], ids=str)
def test_noise_that_passes_a_coupling_is_that_of_a_dense_sum_over_its_resonance(period, shape):
    """At D = 0.01 its peak is 3 rad/s wide, in a band of 3,000 or 50,000 rad/s; the sum takes a tenth of a width."""
    rows = Rows.of(recording(np.random.default_rng(3), duration=2.0, period=period), RIG)
    hypothesis = Hypothesis((Term(catalogue()["elastic_coupling"], shape),))
    layout, smooth, source = lay_out(rows, hypothesis), rows.conditioning.filter, rows.conditioning.source_noise**2
    omega = np.arange(0.0, np.pi / period, 0.1 * shape[0] * shape[1])
    passed = period / np.pi * np.exp(-((omega * smooth.width) ** 2))
    s = 1j * omega / shape[0]
    transfer = -(s**2) / (1.0 + 2.0 * shape[1] * s + s**2)
    behind = np.trapezoid(source * passed * omega**2 * np.abs(transfer) ** 2, omega)
    assert layout.noise[-1, -1] == pytest.approx(behind, rel=2e-3)
    theta = theta_of(layout, inertia=1e-3, viscous=1e-4, strength=6e-4)
    kinetic = 1j * omega * (1e-3 + 6e-4 * transfer) + 1e-4
    power = rows.conditioning.effort_noise**2 + source * np.abs(kinetic) ** 2
    floor = Floor(rows, hypothesis, layout, theta, np.zeros_like(layout.effort)).white
    assert floor == pytest.approx(np.sqrt(np.trapezoid(passed * power, omega)), rel=2e-3)


def test_every_part_of_a_hypothesis_comes_back():
    event = Term(catalogue()["load_torque_event"], (1.0, 1.1), around=(0.9, 1.2))
    hypothesis = Hypothesis((event,), (50.0,), 0.25, 1e-3, True)
    assert all(getattr(hypothesis, each.name) != each.default for each in fields(Hypothesis))
    back = Balance.from_table(
        {"torque_balance": Balance(hypothesis, np.arange(9.0), 2e-3, "log").table()}, "model.toml"
    )
    assert back.hypothesis == hypothesis
    np.testing.assert_array_equal(back.theta, np.arange(9.0))
