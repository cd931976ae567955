"""Effects: everything about one piece of physics in one file, found by discovery."""

import sys
from types import ModuleType
from typing import NoReturn


class Listed(ModuleType):
    """This package, which is no function: a call of it raises an error with the one that is."""

    def __call__(self) -> NoReturn:
        """TypeError with it: the package hides any other meaning of `bench.effects`."""
        raise TypeError("bench.effects is a package; instead: bench.list_effects()")


sys.modules[__name__].__class__ = Listed
