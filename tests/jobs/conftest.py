import logging

import pytest


@pytest.fixture(scope="module")
def cluster():
    """Two Dask workers, as somebody else may have started them."""
    from distributed import LocalCluster

    with LocalCluster(
        2, threads_per_worker=1, dashboard_address="127.0.0.1:0", silence_logs=logging.CRITICAL
    ) as cluster:
        yield cluster
