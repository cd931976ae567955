"""Friction that decays: speed falls by its integral over time."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.signals import Axis
from tests.effects.axes import FREE, Present, moved, signals
from tests.effects.recording import signals as recording

VALUES = {"relative_amplitude": 1.5, "time_constant": 0.3}


def test_dry_friction():
    dry = replace(FREE, coulomb_friction=0.06)
    time, _, velocity = signals(moved([Present.of("friction_warmup", VALUES)], 0.5, velocity=60.0, parameters=dry))
    lost = 0.06 / FREE.inertia * (time + 1.5 * 0.3 * (1.0 - np.exp(-time / 0.3)))
    np.testing.assert_allclose(velocity, 60.0 - lost, atol=1e-5)


def test_viscous_friction_has_its_share():
    viscous = replace(FREE, viscous_friction_coefficient=2e-3)
    effect = Present.of("friction_warmup", {**VALUES, "viscous_share": 0.5})
    time, _, velocity = signals(moved([effect], 0.5, velocity=60.0, parameters=viscous))
    rate = 2e-3 / FREE.inertia * (time + 0.5 * 1.5 * 0.3 * (1.0 - np.exp(-time / 0.3)))
    np.testing.assert_allclose(velocity, 60.0 * np.exp(-rate), rtol=1e-5)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_what_a_fit_found_moves_as_it_was_fitted(share):
    """Strengths of its columns, dry and viscous, as quantities: the torque of the columns is that of the model."""
    effect, base = catalogue()["friction_warmup"], Axis(1e-3, 2e-3, 0.06)
    strengths = [1.5 * base.coulomb, share * 1.5 * base.viscous]
    recorded = recording()
    columns = [values for ((values, _),) in effect.columns(recorded, [0.3])]
    values = effect.report(strengths, [0.3], base)
    assert values == pytest.approx({**VALUES, "viscous_share": share})
    at = recorded.state._replace(friction=base.coulomb * recorded.friction)
    dry, viscous = effect.friction(values, base, at), effect.torque(values, base, at)
    np.testing.assert_allclose(np.array(strengths) @ columns, dry + viscous, atol=1e-12)
