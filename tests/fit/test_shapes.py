"""The search of shapes ends where a valley does not."""

from types import SimpleNamespace

import numpy as np

from bench.effects.catalogue import catalogue
from bench.fit import fit as fitting
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.rows import Rows
from tests.fit.motions import RIG, recording


def test_a_search_along_a_valley_without_an_end_stays_within_numbers(monkeypatch):
    """A residual that falls with damping for ever; 120 steps would take it to 1e49 and beyond."""

    def fit(rows, hypothesis):
        return SimpleNamespace(squares=hypothesis.terms[0].shape[1] ** -4.0, hypothesis=hypothesis)

    monkeypatch.setattr(fitting, "fit", fit)
    rows, coupling = Rows.of(recording(np.random.default_rng(0)), RIG), catalogue()["elastic_coupling"]
    term = Term(coupling, (100.0, 0.04))
    (_, damping) = fitting.shaped(rows, Hypothesis((term,)), 0).hypothesis.terms[0].shape
    assert 1.0 < damping <= 0.04 * np.exp(fitting.FURTHEST * coupling.reach(term.shape, 1)) * (1.0 + 1e-9)
