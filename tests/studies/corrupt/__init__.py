"""Recordings of a plain axis corrupted one way at a time, as sensors, recorders and people do it, with their truth."""
