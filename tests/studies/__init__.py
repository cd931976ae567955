"""Programs that measure, each a folder or file with a command of its own: `python -m tests.studies.NAME --help`.

`docs` has their results: validation, robustness, benchmarks and the pages that these name.
"""
