import logging

import dask
import pytest

#: A scheduler's setting: a thread has no task that waits behind the one it does, and would be suspected with it.
ONE_EACH = {"distributed.scheduler.worker-saturation": 1.0}


@pytest.fixture(scope="module")
def cluster():
    """A Dask worker, as somebody else may have started it."""
    from distributed import LocalCluster

    with (
        dask.config.set(ONE_EACH),
        LocalCluster(
            1, threads_per_worker=1, dashboard_address="127.0.0.1:0", silence_logs=logging.CRITICAL
        ) as cluster,
    ):
        yield cluster
