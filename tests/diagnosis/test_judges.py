"""Held-out motion judges what was named; each judge takes back an effect that the others would have kept."""

import numpy as np
import pytest

from bench.diagnosis.add import add, unlimited
from bench.diagnosis.model import Extension
from bench.diagnosis.name import Suspects
from bench.diagnosis.policy import Policy
from bench.diagnosis.probability import Probabilities
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.diagnosis.search import candidates
from bench.effects.catalogue import catalogue
from bench.effects.effect import Detected
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term
from bench.report.verdict import reason as in_words
from tests.diagnosis.constructed import RIG, SINES, moved, only_during, recorded, wave

MOTION = moved(3.0)
OTHER = moved(3.0, sines=tuple((amplitude, 1.1 * f, phase + 1.0) for amplitude, f, phase in SINES))


def term(name, *shape):
    return Term(catalogue()[name], shape)


def spring(motion):
    return 0.02 * motion.position


def added(trace, holdout, terms, detected=None):
    """What is kept of effects that somebody names."""
    recordings = Recordings.of(trace, RIG, holdout)
    fitted = fit(recordings.rows, Hypothesis(tuple(terms)))
    return add(recordings, Suspects(fitted, (fitted,), Probabilities({}, 1.0), detected or {}, Policy()))


def test_a_share_is_that_of_the_residual_it_was_tried_on():
    """A lower cut-off takes a vibration of 40 Hz away, and with it most of the residual that the share is of."""
    trace = recorded(MOTION, spring, lambda motion: 0.3 * np.sin(2.0 * np.pi * 40.0 * motion.time))
    bare = fit_bare(Recordings.of(trace, RIG, None).rows)
    (tried,) = candidates(bare, [catalogue()["torsion_spring"]])
    with_spring = fit(bare.rows, Hypothesis((tried.term,)))
    assert tried.share == pytest.approx(1.0 - with_spring.squares / bare.squares, rel=1e-3)


def test_what_both_recordings_show_is_kept():
    result = added(
        recorded(MOTION, wave(0.02, 17.0)), recorded(OTHER, wave(0.02, 17.0), seed=1), [term("cogging_torque", 17.0)]
    )
    assert result.rejected == ()


def test_torque_that_the_holdout_does_not_need_is_rejected_by_the_torque_gap():
    """A ripple so fast that inertia hides it in speed: only torque tells."""
    ((name, reason),) = added(
        recorded(MOTION, wave(0.02, 17.0)), recorded(OTHER, seed=1), [term("cogging_torque", 17.0)]
    ).rejected
    assert name == "cogging_torque"
    assert in_words(reason).startswith("the torque gap of the holdout grows")


def test_a_lag_that_torque_does_not_feel_is_rejected_by_the_velocity_gap():
    lag = {catalogue()["velocity_filter_lag"]: Detected({"time_constant": 4e-3}, {"time_constant": 1e-5})}
    trace, holdout = recorded(MOTION, spring), recorded(OTHER, spring, seed=1)
    ((name, reason),) = added(trace, holdout, [term("torsion_spring")], lag).rejected
    assert name == "velocity_filter_lag"
    assert in_words(reason).startswith("the velocity gap of the holdout grows")


def test_an_event_of_the_recording_is_not_judged_by_a_holdout_without_it():
    event = [term("load_torque_event", 1.0, 1.5)]
    assert added(recorded(MOTION, only_during(0.08, 1.0, 1.5)), recorded(OTHER, seed=1), event).rejected == ()


@pytest.mark.parametrize(("gap", "kept"), [((1.0, 2.0), False), ((2.0, 1.0), True), (None, True)])
def test_what_shows_under_the_drive_only_has_to_help_there(gap, kept):
    rows = Recordings.of(recorded(MOTION, spring), RIG, None).rows
    limit = {catalogue()["voltage_limit"]: Detected({"voltage": 40.0}, {"voltage": 1.0})}
    against = unlimited(Extension(rows, Hypothesis((term("torsion_spring"),)), limit, RIG), gap)
    if kept:
        assert against is None
    else:
        assert against is not None
        assert (against[0], "under the rig's drive grows" in in_words(against[1])) == (1, True)
