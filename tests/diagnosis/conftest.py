"""What tests of commands share."""

import pytest

from tests import command
from tests.diagnosis.command import RIG


@pytest.fixture
def bench(monkeypatch, tmp_path):
    """Runs `bench` in a folder of its own, which holds a rig file."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.toml").write_text(RIG, encoding="utf-8")
    return command.bench
