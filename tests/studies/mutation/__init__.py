"""Mutants of the bench: each rule off, each column turned or dropped, each property of an effect unset.

`python -m tests.studies.mutation --help`; what it last found: docs/mutation.md.
"""
