"""Files with one bit flipped: `python -m tests.studies.corrupt.flips --help`."""
