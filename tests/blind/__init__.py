"""The blind set: hidden effects drawn at random, diagnosed from trace and rig file alone, the truth opened after.

`python -m tests.blind --help`; what it measures and last measured: docs/blind.md.
"""
