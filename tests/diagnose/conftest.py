"""What tests of commands share."""

import pytest

from tests.diagnose.command import started


@pytest.fixture
def bench(capsys, monkeypatch, tmp_path):
    """Runs `bench` in a folder of its own and returns status, standard output and standard error."""
    monkeypatch.chdir(tmp_path)
    run = started(tmp_path)

    def told(*arguments):
        status = run(*arguments)
        printed = capsys.readouterr()
        return status, printed.out, printed.err

    return told
