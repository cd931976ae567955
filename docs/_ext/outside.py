"""Links to files outside the folder of pages, where a git host finds them, lead to the pages that include them."""

from __future__ import annotations

from sphinx.application import Sphinx

#: Files outside the folder, and the page that includes each.
INCLUDED = {"../CONTRIBUTING.md": "contributing.md", "../SECURITY.md": "security.md", "../CHANGELOG.md": "changelog.md"}


def lead_inside(app: Sphinx, name: str, source: list[str]) -> None:
    """Rewrite the links of a page as it is read."""
    for outside, page in INCLUDED.items():
        source[0] = source[0].replace(f"]({outside})", f"]({page})")


def lead_included(app: Sphinx, path: object, name: str, source: list[str]) -> None:
    """Rewrite the links of an included file, which start from its own folder."""
    for outside, page in INCLUDED.items():
        source[0] = source[0].replace(f"]({outside.removeprefix('../')})", f"]({page})")
    source[0] = source[0].replace("](docs/", "](")


def setup(app: Sphinx) -> dict[str, bool]:
    """Before links are resolved."""
    app.connect("source-read", lead_inside)
    app.connect("include-read", lead_included)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
