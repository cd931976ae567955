"""The catalogue: every effect there is a file of."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache
from types import MappingProxyType

import bench.effects
from bench.effects.effect import Effect


@cache
def catalogue() -> MappingProxyType[str, Effect]:
    """Effects by name, each from the module of that name."""
    modules = (
        importlib.import_module(f"bench.effects.{info.name}") for info in pkgutil.iter_modules(bench.effects.__path__)
    )
    found = [module.EFFECT for module in modules if "EFFECT" in vars(module)]
    return MappingProxyType({effect.name: effect for effect in found})
