"""Units: SI inside, other units at the edges only (files and command line), where pint reads them."""

from bench.units.conversion import affine, base_units, convert, dimensionality, same_dimension
from bench.units.quantity import Quantity
from bench.units.value import parse, parse_with_tolerance

__all__ = [
    "Quantity",
    "affine",
    "base_units",
    "convert",
    "dimensionality",
    "parse",
    "parse_with_tolerance",
    "same_dimension",
]
