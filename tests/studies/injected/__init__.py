"""Known effects put into recordings of real axes and of realistic simulated ones: what of them is named.

`python -m tests.studies.injected --help`; how it judges: docs/validation.md.
"""
