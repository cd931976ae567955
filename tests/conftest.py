"""How tests run side by side: a numeric thread a process, and in one process what shares a fixture."""

import os

from xdist.scheduler import LoadScopeScheduling

#: Folders whose files share a fixture of the session; elsewhere every file goes its own way.
TOGETHER = ("tests/effects/", "tests/lab/")

# before NumPy is loaded: the threads of several processes would fight over the cores
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(threads, "1")


class Sharing(LoadScopeScheduling):
    """Files side by side, but for those of a folder that shares."""

    def _split_scope(self, nodeid: str) -> str:
        folder = next((folder for folder in TOGETHER if nodeid.startswith(folder)), None)
        return folder or super()._split_scope(nodeid)


def pytest_xdist_make_scheduler(config, log):
    return Sharing(config, log)


def pytest_xdist_auto_num_workers(config):
    """None beside this process where a measurement would suffer, or somebody reads along with `-s`."""
    alone = config.option.capture == "no" or config.option.benchmark_only
    return 0 if alone else None
