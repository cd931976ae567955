"""The blind set: hidden effects drawn at random, diagnosed from trace and rig file alone, the truth opened after.

`python -m tests.studies.blind --help`; what it measures and last measured: docs/validation.md.
"""
