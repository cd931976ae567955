"""Every nuisance there is."""

from tests.studies.nuisance.kinds import current, motion, position_and_speed, rig, time
from tests.studies.nuisance.nuisance import Nuisance, named


def _in(module) -> list[type[Nuisance]]:
    """Nuisances that a module defines, in its order."""
    found = [kind for kind in vars(module).values() if isinstance(kind, type) and issubclass(kind, Nuisance)]
    return [kind for kind in found if kind.__module__ == module.__name__]


#: By name; the control first.
NUISANCES: dict[str, Nuisance] = {
    named(kind()): kind()
    for kind in (
        Nuisance,
        *(kind for module in (position_and_speed, current, time, motion, rig) for kind in _in(module)),
    )
}
