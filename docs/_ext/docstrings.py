"""Docstrings of the bench for Sphinx: they are plain text, in which a star is a product and `this` is code."""

from __future__ import annotations

import re

from sphinx.application import Sphinx

#: Headings of sections, which `sphinx.ext.napoleon` reads afterwards.
SECTIONS = ("Args:", "Attributes:", "Raises:", "Returns:", "Source:")


def as_text(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """Have stars, bars and underscores mean themselves, and an indented block be an equation."""
    made: list[str] = []
    inside = False
    for line in lines:
        if line.strip() in SECTIONS:
            inside = True
        elif line and not line.startswith(" "):
            inside = False
        equation = line.startswith("    ") and not inside
        if equation and made and not made[-1] and not (len(made) > 1 and made[-2].startswith("    ")):
            made += ["::", ""]
        named = re.match(r"    [\w, ]+: ", line) if inside else None
        start = named.end() if named else 0  # names of arguments are taken as they stand
        made.append(line if equation else line[:start] + escaped(line[start:]))
    lines[:] = made


def escaped(line: str) -> str:
    """A line in which only code is markup."""
    parts = re.split(r"(`[^`]*`)", line)
    return "".join(f"`{part}`" if part.startswith("`") else re.sub(r"([*|_\\])", r"\\\1", part) for part in parts)


def setup(app: Sphinx) -> dict[str, bool]:
    """Before napoleon, whose priority is 500."""
    app.setup_extension("sphinx.ext.autodoc")
    app.connect("autodoc-process-docstring", as_text, priority=400)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
