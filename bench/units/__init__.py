"""Units: SI inside, other units at the edges only (files and command line), where pint reads them."""

from bench.units.conversion import convert, dimensionality, same_dimension
from bench.units.quantity import Quantity, parse, parse_with_tolerance

__all__ = ["Quantity", "convert", "dimensionality", "parse", "parse_with_tolerance", "same_dimension"]
