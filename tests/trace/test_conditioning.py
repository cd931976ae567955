import numpy as np
import pytest
import scipy.signal

from bench.trace.conditioning import _coherence


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(("samples", "window"), [(72, 16), (999, 64), (20_000, 1024)])
def test_coherence_is_scipys(samples, window, order):
    rng = np.random.default_rng(samples)
    source = np.cumsum(rng.normal(size=samples))
    effort = np.gradient(source) + rng.normal(size=samples)
    frequency, coherence = _coherence([(source, effort)], 1e-3, order)
    expected = scipy.signal.coherence(np.diff(source, order), effort[order:], fs=1e3, nperseg=window)
    np.testing.assert_allclose(frequency, expected[0][1:-1], rtol=1e-12)
    np.testing.assert_allclose(coherence, expected[1][1:-1], atol=1e-12)


def test_a_signal_that_never_changes_shares_nothing():
    _, coherence = _coherence([(np.zeros(500), np.random.default_rng(0).normal(size=500))], 1e-3, 1)
    assert not coherence.any()
