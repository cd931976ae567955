"""How often `bench check` calls an axis changed that is not: `python -m tests.studies.false_alarms`."""
