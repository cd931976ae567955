"""The catalogue: every effect there is a file of."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache
from types import MappingProxyType

import bench.effects
from bench.effects.effect import Effect
from bench.effects.physics import Physics


@cache
def physics() -> MappingProxyType[str, Physics]:
    """All effects by name, each from the module of that name."""
    modules = (
        importlib.import_module(f"bench.effects.{info.name}") for info in pkgutil.iter_modules(bench.effects.__path__)
    )
    found = [vars(module)["EFFECT"] for module in modules if "EFFECT" in vars(module)]
    return MappingProxyType({effect.name: effect for effect in found})


@cache
def catalogue() -> MappingProxyType[str, Effect]:
    """Effects that add columns to the torque balance, by name."""
    return MappingProxyType({name: effect for name, effect in physics().items() if isinstance(effect, Effect)})
