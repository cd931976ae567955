"""Plugin of pytest that makes a mutant of the bench before any test is imported."""

import os

from tests.studies.mutation.mutants import MUTANT, mutants

if MUTANT in os.environ:
    mutants()[os.environ[MUTANT]].apply()
