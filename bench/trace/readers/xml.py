"""XML files of controllers, told apart by their root element."""

from __future__ import annotations

import re
from xml.etree import ElementTree

from bench.errors import InputError
from bench.trace.source import Source

_ROOT = re.compile(r"<([A-Za-z_][\w:.-]*)")


def root_name(source: Source) -> str:
    """Name of the root element without its namespace; empty if the content is no XML."""
    head = source.head.lstrip()
    match = _ROOT.search(_without_comments(head)) if head.startswith("<") else None
    return match[1].rsplit(":", 1)[-1] if match else ""


def _without_comments(text: str) -> str:
    """The text up to the first comment that is not closed."""
    kept, place = [], 0
    while (start := text.find("<!--", place)) >= 0:
        kept.append(text[place:start])
        end = text.find("-->", start + 4)
        if end < 0:
            return "".join(kept)
        place = end + 3
    return "".join([*kept, text[place:]])


def parse(source: Source) -> ElementTree.Element:
    """Root element; its namespaces are left out of all names.

    Raises:
        InputError: not well-formed, as a truncated file is not.
    """
    try:
        text: str | bytes = source.content.decode("utf-8")  # a str, for the declaration may still say utf-16
    except UnicodeDecodeError:
        text = source.content
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        raise InputError(
            source.path, f"the XML is truncated or damaged ({error})", "allowed: a complete XML"
        ) from error
    for element in root.iter():
        element.tag = element.tag.rsplit("}", 1)[-1]
    return root
