"""How a fleet of thousands goes, and what its changes miss: `python -m tests.studies.fleet --help`."""
