"""servobench: a physics-backed test bench for a servo axis.

The public names of the bench. Each is imported when it is first used, so that `import bench` is fast.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from bench.errors import BenchError, InputError, UndeterminedError
from bench.names import instead, same_as
from bench.presented import Renderer, Shown

if TYPE_CHECKING:
    from bench.baseline.check import Checked, check
    from bench.diagnosis.diagnosis import Diagnosis, diagnose
    from bench.diagnosis.replay import replay
    from bench.effects.catalogue import list_effects
    from bench.export.effects import Effects
    from bench.fit.estimate import Estimate
    from bench.fit.frequency_response import frequency_response
    from bench.fit.identify import identify
    from bench.joints.robot import IdentifiedRobot, robot
    from bench.plant.simulate import simulate
    from bench.rig.rig import Rig, load_rig
    from bench.servos.servo import Servo, servo
    from bench.trace.read import read
    from bench.trace.trace import Trace

__all__ = [
    "BenchError",
    "Checked",
    "Diagnosis",
    "Effects",
    "Estimate",
    "IdentifiedRobot",
    "InputError",
    "Rig",
    "Servo",
    "Trace",
    "UndeterminedError",
    "__version__",
    "check",
    "diagnose",
    "frequency_response",
    "identify",
    "list_effects",
    "load_rig",
    "read",
    "replay",
    "robot",
    "servo",
    "simulate",
]
__version__ = "0.1.0"

#: Module of each name; a test compares it with the imports above, which type checkers read.
_MODULES = {
    "Checked": "bench.baseline.check",
    "Diagnosis": "bench.diagnosis.diagnosis",
    "Effects": "bench.export.effects",
    "Estimate": "bench.fit.estimate",
    "IdentifiedRobot": "bench.joints.robot",
    "Rig": "bench.rig.rig",
    "Servo": "bench.servos.servo",
    "Trace": "bench.trace.trace",
    "check": "bench.baseline.check",
    "diagnose": "bench.diagnosis.diagnosis",
    "frequency_response": "bench.fit.frequency_response",
    "identify": "bench.fit.identify",
    "list_effects": "bench.effects.catalogue",
    "load_rig": "bench.rig.rig",
    "read": "bench.trace.read",
    "replay": "bench.diagnosis.replay",
    "robot": "bench.joints.robot",
    "servo": "bench.servos.servo",
    "simulate": "bench.plant.simulate",
}


def _renderer() -> Renderer:
    """What shows results, whose imports only a result that is shown has to pay."""
    from bench.report import notebook

    return notebook


Shown.renderer = staticmethod(_renderer)


def __getattr__(name: str) -> object:
    if (same := same_as(name, __all__)) is not None:
        return globals().get(same) or __getattr__(same)
    if name not in _MODULES:
        raise AttributeError(f"bench has no '{name}'{instead(name, __all__)}")
    return getattr(import_module(_MODULES[name]), name)


def __dir__() -> list[str]:
    return [*__all__]
