"""The engine: rows, hypotheses and their fits."""
