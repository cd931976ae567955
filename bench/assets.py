"""Where the files that travel with the bench lie: next to the sources, or inside the installed package."""

from importlib.resources import files
from pathlib import Path


def asset(*parts: str) -> Path:
    """Path of a file of `data/` or `mjcf/`, e.g. `asset("data", "rigs", "sh30701p.toml")`."""
    package = Path(str(files("bench")))
    inside = package.joinpath(*parts)
    return inside if package.joinpath(parts[0]).exists() else package.parent.joinpath(*parts)
