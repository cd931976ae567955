"""One dotted key of 32,000 parts, in place of a rig."""

from pathlib import Path

from tests.hostile import TABLE


def write(folder: Path) -> None:
    (folder / "log.csv").write_text(TABLE, encoding="utf-8")
    (folder / "dots.toml").write_text(".".join(["a"] * 32_000) + " = 1\n", encoding="utf-8")
