"""Programs that measure, each a folder or file with a command of its own: `python -m tests.studies.NAME --help`.

benchmarks     how fast the bench is beside other ways
blind          hidden effects drawn at random, and the names that a diagnosis gives
crash          commands killed, full disks, two writers
exports        files as drives and loggers export them, held to their truth
false_alarms   how often a check calls an axis changed that is not
fleet          thousands of recordings, some of which change
fuzz           what reads, given anything
mutation       the bench changed in one place, and whether a test notices
nuisance       damaged recordings, and realistic axes
outputs        what every command answers, written down and compared
"""
