"""How often `bench check` calls an axis changed that is not, and the same that is not: `python -m tests.baseline`."""
