"""servobench: a physics-backed test bench for a servo axis.

The public names of the bench. Each is imported when it is first used, so that `import bench` is fast.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

from bench.errors import BenchError, InputError, UndeterminedError

if TYPE_CHECKING:
    from bench.check.check import check
    from bench.check.compare import Checked
    from bench.diagnose.diagnosis import diagnose
    from bench.diagnose.replay import replay
    from bench.diagnose.show.show import Diagnosis
    from bench.export.effects import Effects
    from bench.identify.estimate import Estimate
    from bench.identify.regression import identify
    from bench.plant.simulate import simulate
    from bench.rig.rig import Rig, load_rig
    from bench.trace.read import read
    from bench.trace.trace import Trace

__all__ = [
    "BenchError",
    "Checked",
    "Diagnosis",
    "Effects",
    "Estimate",
    "InputError",
    "Rig",
    "Trace",
    "UndeterminedError",
    "__version__",
    "check",
    "diagnose",
    "identify",
    "load_rig",
    "read",
    "replay",
    "simulate",
]
__version__ = "0.1.0"

#: Module of each name; a test compares it with the imports above, which type checkers read.
_MODULES = {
    "Checked": "bench.check.compare",
    "Diagnosis": "bench.diagnose.show.show",
    "Effects": "bench.export.effects",
    "Estimate": "bench.identify.estimate",
    "Rig": "bench.rig.rig",
    "Trace": "bench.trace.trace",
    "check": "bench.check.check",
    "diagnose": "bench.diagnose.diagnosis",
    "identify": "bench.identify.regression",
    "load_rig": "bench.rig.rig",
    "read": "bench.trace.read",
    "replay": "bench.diagnose.replay",
    "simulate": "bench.plant.simulate",
}


class _LazyModule(ModuleType):
    """Imports a name when it is first used, and keeps it although a package has the same one.

    `identify`, `diagnose` and `check` are functions here and packages below. The import of such a package ends with
    `setattr(bench, "identify", <package>)`, after which `bench.identify(...)` would call a module. This assignment is
    ignored, so `bench.identify` is always the function, while `from bench.identify.regression import ...` finds the
    package in `sys.modules`. (Only `import bench.identify.regression as r` does not work: it uses the attribute.)
    """

    def __getattr__(self, name: str) -> object:
        if name not in _MODULES:
            raise AttributeError(f"module 'bench' has no attribute '{name}'")
        return getattr(import_module(_MODULES[name]), name)

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _MODULES and isinstance(value, ModuleType)):
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *__all__})


sys.modules[__name__].__class__ = _LazyModule
