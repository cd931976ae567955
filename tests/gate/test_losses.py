"""Lost and repeated samples are put right, or refused."""

import numpy as np
import pytest

from bench.fit.identify import identify
from bench.gate import repairs
from bench.gate.gate import gate
from tests.gate.damage import doubled, losing, stale, with_samples, without
from tests.independent.axes import PLAIN


@pytest.mark.parametrize("damage", [losing, stale, doubled])
@pytest.mark.parametrize("share", [0.001, 0.005])
@pytest.mark.parametrize("seed", range(2))
def test_lost_and_repeated_samples_are_put_right(sound, rig, damage, share, seed):
    damaged = damage(sound, share, seed)
    gated = gate(damaged, rig, [repairs.none_lost])
    assert gated.checks[0].status == "warn"
    assert identify(gated.trace, rig)["moment_of_inertia"].value == pytest.approx(PLAIN.inertia, rel=0.01)


def test_each_place_of_a_loss_is_found(sound, rig):
    places = [900, 1800, 2700]
    kept = np.delete(np.arange(len(sound)), places)
    speed = np.abs(sound["velocity"][places])
    assert speed.min() > 5.0, "the axis has to move where samples are lost"
    missing, again = repairs.damage_of(with_samples(sound, kept))
    assert np.flatnonzero(missing).tolist() == [k - 1 - n for n, k in enumerate(places)]
    mended = repairs.repaired(with_samples(sound, kept), missing, again)
    assert mended.time == pytest.approx(sound.time)
    assert np.abs(mended["position"] - sound["position"]).max() < 0.01 * np.abs(np.diff(sound["position"])).max()


def test_a_longer_loss_is_a_hole(sound, rig):
    kept = np.delete(np.arange(len(sound)), np.arange(1500, 1520))
    gated = gate(with_samples(sound, kept), rig, [repairs.none_lost])
    assert "20 samples lost" in gated.checks[0].found
    assert [part.stop for part in gated.trace.segments] == [1500, len(sound) - 20]
    assert gated.trace.time[-1] == pytest.approx(sound.time[-1])


def test_losses_that_no_speed_confirms_are_refused(sound, rig):
    alone = without(sound, "velocity")
    assert gate(alone, rig, [repairs.none_lost]).checks[0].status == "pass"
    assert gate(losing(alone, 0.005), rig, [repairs.none_lost]).checks[0].status == "fail"
