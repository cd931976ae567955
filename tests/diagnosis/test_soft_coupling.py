"""The load behind a soft coupling: against its equation integrated elsewhere, and found in simulated recordings."""

import numpy as np
import pytest
import scipy.integrate

from bench.diagnosis.policy import Policy
from bench.diagnosis.recordings import fit_bare
from bench.diagnosis.search import search
from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.rows import Rows
from bench.trace.trace import Trace
from bench.validation.independent.effects import ElasticCoupling, PreslidingFriction
from bench.validation.independent.references import random_motion
from tests.recorded import QUIET

ELASTIC = catalogue()["elastic_coupling"]
PERIOD = 1e-3
COUPLING, BRISTLES = ElasticCoupling(14.0, 2.5e-3), PreslidingFriction(3.0, 8e-3)
SEED, RIGID = 5, "rigid"


@pytest.fixture(scope="module")
def recorded():
    """A recording by the name of the effect in it: of a rigid axis, too."""
    effects = {COUPLING.name: (COUPLING,), BRISTLES.name: (BRISTLES,), RIGID: ()}
    motion = random_motion(QUIET.axis, np.random.default_rng(SEED), 4.0)
    return QUIET.record(effects, motion, SEED, dict.fromkeys(effects, 0))


@pytest.mark.parametrize(("drag", "ends"), [(0.0, 4.0), (0.02, 4.0), (0.0, 3.7)])
def test_the_load_moves_as_its_equation_says(drag, ends):
    """A recording that ends in motion rings on behind its end, and none of that comes back at its start."""
    antiresonance, damping = 150.0, 0.01
    time = np.arange(0.0, ends, PERIOD)
    turn, speed = 2.0 * np.pi / 4.0, 60.0
    angle, velocity = speed / turn * (1.0 - np.cos(turn * time)), speed * np.sin(turn * time)
    values = {"position": angle, "velocity": velocity, "current": 0.12 * np.cos(turn * time) + 0.1 * np.sign(velocity)}
    rows = Rows.of(Trace(time, values, {"position": "rad", "velocity": "rad/s", "current": "A"}, "swing"), QUIET.rig)

    def equation(t, state):
        motor, rate = speed / turn * (1.0 - np.cos(turn * t)), speed * np.sin(turn * t)
        pull = antiresonance**2 * (motor - state[0]) + 2.0 * damping * antiresonance * (rate - state[1])
        return [state[1], pull - drag * state[1] * abs(state[1])]

    load = scipy.integrate.solve_ivp(equation, (0.0, ends), [0.0, 0.0], t_eval=time, rtol=1e-8, atol=1e-9).y
    acting = [(catalogue()["quadratic_drag"], (), (drag,))] if drag else []
    found = rows.table(lambda s: ELASTIC.columns_of(s, [(antiresonance, damping)], acting))[:, 0]
    excess = drag * (load[1] * np.abs(load[1]) - velocity * np.abs(velocity))
    expected = rows.table(lambda s: [[(load[0] - angle, 2), (excess, 0)]])[:, 0]
    assert found == pytest.approx(expected, abs=2e-3 * np.abs(expected).max())


def test_a_soft_coupling_leaves_noise_alone(recorded):
    effect = COUPLING
    rows = Rows.of(recorded[effect.name], QUIET.rig)
    antiresonance = np.sqrt(effect.stiffness / (QUIET.axis.inertia - QUIET.axis.rotor_inertia))
    shape = float(antiresonance), 0.5 * effect.damping * float(antiresonance) / effect.stiffness
    fitted = fit(rows, Hypothesis((Term(ELASTIC, shape),)))
    assert fitted.chi == pytest.approx(fit_bare(Rows.of(recorded[RIGID], QUIET.rig)).chi, rel=0.05)
    assert fitted.theta[0] == pytest.approx(QUIET.axis.inertia, rel=2e-4)
    assert fitted.strengths(0)[0] == pytest.approx(QUIET.axis.inertia - QUIET.axis.rotor_inertia, rel=5e-4)


@pytest.mark.parametrize("name", [COUPLING.name, BRISTLES.name])
def test_none_is_proposed_without_a_load_behind_it(recorded, name):
    """Beside what is hidden still the load of most shapes comes out negative; one of these stood for all others."""
    bare = fit_bare(Rows.of(recorded[name], QUIET.rig))
    gains, loads = [], []
    for proposal in ELASTIC.propose(bare):
        gains.append(proposal.gain)
        loads.append(fit(bare.rows, bare.hypothesis.plus(Term(ELASTIC, proposal.shape))).strengths(0)[0])
    proposed = np.array(gains) > 1e-3 * max(gains)
    assert (np.array(loads)[proposed] > 0.0).all()
    assert (np.array(loads) < 0.0).any()


def test_bristles_are_named_with_their_damping(recorded):
    effect = BRISTLES
    fitted = search(fit_bare(Rows.of(recorded[effect.name], QUIET.rig)), list(catalogue().values()), Policy()).last
    assert fitted.hypothesis.names == ("presliding_friction",)
    assert fitted.chi < 1.1
    values = fitted.terms[0].effect.report(fitted.strengths(0), fitted.terms[0].shape, fitted.base)
    assert values["bristle_stiffness"] == pytest.approx(effect.bristle_stiffness, rel=0.03)
    assert values["bristle_damping"] == pytest.approx(effect.bristle_damping, rel=0.15)
    assert fitted.theta[0] == pytest.approx(QUIET.axis.inertia, rel=1e-3)
