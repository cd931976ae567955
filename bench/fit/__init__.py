"""Identification: inertia and friction from a motion, with honest uncertainty."""
