"""How tests run side by side: a numeric thread a process, and in one process what shares a fixture."""

import os

from hypothesis import HealthCheck, settings
from xdist.scheduler import LoadScopeScheduling

#: Files that share a fixture of the session, by its name; every other file goes its own way.
TOGETHER = {
    "truths": tuple(f"tests/effects/test_{name}.py" for name in ("agreement", "follow", "model_file", "soft_tracking")),
    "lab": ("tests/course/",),
}

# before NumPy is loaded: the threads of several processes would fight over the cores
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

# a busy machine is no failure
settings.register_profile("unhurried", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("unhurried")


class Sharing(LoadScopeScheduling):
    """Files side by side, but for those that share."""

    def _split_scope(self, nodeid: str) -> str:
        shared = (fixture for fixture, files in TOGETHER.items() if nodeid.startswith(files))
        return next(shared, super()._split_scope(nodeid))


def pytest_xdist_make_scheduler(config, log):
    return Sharing(config, log)


def pytest_xdist_auto_num_workers(config):
    """None beside this process where a measurement would suffer, or somebody reads along with `-s`."""
    alone = config.option.capture == "no" or config.option.benchmark_only
    return 0 if alone else None
