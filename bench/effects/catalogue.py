"""The catalogue: every effect there is a file of, here and in packages that offer some.

Another package offers effects as entry points of the group `servobench.effects`, each an effect:

    [project.entry-points."servobench.effects"]
    belt_creep = "their_package.belt_creep:EFFECT"
"""

import importlib
import pkgutil
from functools import cache
from types import MappingProxyType

import bench.effects
from bench.effects.effect import Effect
from bench.effects.signals import Scope
from bench.errors import InputError
from bench.names import with_known_arguments
from bench.offered import EFFECTS_GROUP, offered
from bench.presented import ByKey


@cache
def catalogue() -> MappingProxyType[str, Effect]:
    """All effects by name, each from the module or folder of that name, then those of other packages.

    InputError where what another package offers is no effect, or has the name of one.
    """
    modules = (
        importlib.import_module(f"bench.effects.{info.name}") for info in pkgutil.iter_modules(bench.effects.__path__)
    )
    found: dict[str, Effect] = {}
    for module in modules:
        if "EFFECT" in vars(module):
            effect = vars(module)["EFFECT"]
            found[effect.name] = effect
    for _, effect in offered(EFFECTS_GROUP, Effect, "an effect of the bench"):
        if effect.name in found:
            raise InputError(
                f"{EFFECTS_GROUP}: {effect!r}", f"found '{effect.name}' again", "allowed: a name of its own"
            )
        found[effect.name] = effect
    return MappingProxyType(found)


@with_known_arguments
def list_effects() -> dict[str, str]:
    """Every effect by its name, as `diagnose` takes it, and what it is."""
    return ByKey({name: effect.summary for name, effect in sorted(catalogue().items())})


def simpler_forms(effect: Effect, scope: Scope) -> list[Effect]:
    """Effects of fewer quantities that such a recording cannot distinguish from one: it, where some of its are zero."""
    others = [catalogue()[name] for name in effect.ambiguous(scope) if name in catalogue()]
    return [other for other in others if len(other.quantities) < len(effect.quantities)]
