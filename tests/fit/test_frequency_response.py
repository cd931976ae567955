"""Frequency response of one and of two masses, stepped by an integrator of the test's own."""

import numpy as np
import pytest

import bench
from bench.fit.frequency_response import response_of

PERIOD, FINER, SECONDS = 1e-3, 20, 10.0
MOTOR, LOAD, VISCOUS, COULOMB, DAMPING = 1e-3, 2e-3, 2e-3, 0.02, 0.02


def two_masses(excited, antiresonance, seed):
    """Torque and speed (n,) of a motor with a load behind a spring, semi-implicit Euler at 50 us."""
    rng, step, count = np.random.default_rng(seed), PERIOD / FINER, round(SECONDS / PERIOD)
    time = step * np.arange(count * FINER)
    if excited == "chirp":
        push = 0.4 * np.sin(2.0 * np.pi * (time + 119.0 / (2.0 * SECONDS) * time**2))
    elif excited == "multisine":
        push = np.zeros_like(time)
        for line in range(1, 150):
            push += 0.06 * np.sin(2.0 * np.pi * line * time + rng.uniform(0.0, 6.28))
    else:  # steps that are held between samples
        push = np.repeat(0.4 * rng.normal(size=count), FINER)
    stiffness = LOAD * (2.0 * np.pi * antiresonance) ** 2
    damping = 2.0 * DAMPING * stiffness / (2.0 * np.pi * antiresonance)
    twist = speed = behind = 0.0
    torque, found = np.empty((2, count))
    for k, given in enumerate(push.tolist()):
        given -= 0.02 * speed
        if k % FINER == 0:
            torque[k // FINER], found[k // FINER] = given, speed
        between = stiffness * twist + damping * (speed - behind)
        speed += step * (given - VISCOUS * speed - COULOMB * np.tanh(speed / 0.2) - between) / MOTOR
        behind += step * between / LOAD
        twist += step * (speed - behind)
    return torque + 5e-3 * rng.normal(size=count), found + 0.05 * rng.normal(size=count)


@pytest.mark.parametrize(("excited", "within"), [("chirp", 0.005), ("multisine", 0.005), ("held steps", 0.01)])
def test_resonance_and_antiresonance_of_two_masses(excited, within):
    """Resonance at sqrt(k*(1/J_m + 1/J_l)), antiresonance at sqrt(k/J_l)."""
    antiresonance = 41.3
    found = response_of([two_masses(excited, antiresonance, 3)], PERIOD)
    assert found is not None
    for told, truth in ((found.antiresonance, antiresonance), (found.resonance, antiresonance * np.sqrt(3.0))):
        assert told is not None
        assert told.value == pytest.approx(truth, rel=within)
        assert told.ci95[0] <= truth <= told.ci95[1]


def rigid(noise=0.05, inertia=3e-3, samples=10_000):
    rng = np.random.default_rng(0)
    torque = 0.4 * rng.normal(size=samples)
    speed = PERIOD / inertia * np.concatenate([[0.0], np.cumsum(torque[:-1])])
    return torque + 5e-3 * rng.normal(size=samples), speed + noise * rng.normal(size=samples)


def test_one_mass_is_one_over_inertia_and_resonates_nowhere():
    found = response_of([rigid()], PERIOD)
    assert found is not None
    assert (found.resonance, found.antiresonance) == (None, None)
    low = found.coherent & (found.frequency < 50.0) & (found.frequency > 2.0)
    size = np.abs(found.response[low]) * 2.0 * np.pi * found.frequency[low]
    assert size * 3e-3 == pytest.approx(np.ones(size.size), abs=0.1)
    away = (size * 3e-3 - 1.0) / found.error[low]
    assert 0.5 < np.sqrt(np.mean(away**2)) < 1.6


def test_noise_alone_has_no_response():
    rng = np.random.default_rng(1)
    assert response_of([(rng.normal(size=10_000), rng.normal(size=10_000))], PERIOD) is None


def test_a_short_recording_has_none():
    torque, speed = rigid(samples=600)
    assert response_of([(torque, speed)], PERIOD) is None


def test_arrays_without_a_rig_are_answered():
    torque, speed = rigid()
    found = bench.frequency_response({"time": PERIOD * np.arange(10_000), "torque": torque, "velocity": speed})
    alone = response_of([(torque, speed)], PERIOD)
    assert found is not None
    assert alone is not None
    assert np.array_equal(found.response, alone.response)
