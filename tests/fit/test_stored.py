"""A balance in a file is the balance that was fitted."""

from dataclasses import fields

import numpy as np

from bench.effects.catalogue import catalogue
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.stored import Balance


def test_every_part_of_a_hypothesis_comes_back():
    event = Term(catalogue()["load_torque_event"], (1.0, 1.1), around=(0.9, 1.2))
    hypothesis = Hypothesis((event,), (50.0,), 0.25, 1e-3, True)
    assert all(getattr(hypothesis, each.name) != each.default for each in fields(Hypothesis))
    back = Balance.from_table(Balance(hypothesis, np.arange(9.0), 2e-3, "log").table(), "model.toml")
    assert back.hypothesis == hypothesis
    np.testing.assert_array_equal(back.theta, np.arange(9.0))
