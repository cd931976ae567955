"""Rigs: what is known about an axis before anyone identifies it."""
