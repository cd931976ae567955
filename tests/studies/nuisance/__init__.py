"""The nuisance set: sound recordings of an independent integrator, damaged as the world damages recordings.

`python -m tests.studies.nuisance --help`; what it measures and last measured: docs/validation.md.
"""
