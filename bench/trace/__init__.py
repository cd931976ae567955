"""Traces: one recording of one axis, its formats, and the motion filtered from it."""
