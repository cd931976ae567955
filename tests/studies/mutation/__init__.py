"""Mutants of the bench, drawn at random: one operator, number or condition changed, and the tests asked to notice.

`python -m tests.studies.mutation --help`
"""
