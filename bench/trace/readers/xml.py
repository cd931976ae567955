"""XML files of controllers, told apart by their root element.

Sinumerik frequency responses are recognised so that the user learns why they are no trace of a motion.
"""

from __future__ import annotations

import re
from typing import NoReturn
from xml.etree import ElementTree

from bench.errors import InputError
from bench.trace.source import FileFormat, Source

#: A comment, which need not be closed.
_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_ROOT = re.compile(r"<([A-Za-z_][\w:.-]*)")


def root_name(source: Source) -> str:
    """Name of the root element without its namespace; empty if the content is no XML."""
    head = source.head.lstrip()
    match = _ROOT.search(_COMMENT.sub("", head)) if head.startswith("<") else None
    return match[1].rsplit(":", 1)[-1] if match else ""


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
        found = f"the XML is truncated or damaged ({error})"
        raise InputError(source.path, found, "allowed: a complete XML") from error
    for element in root.iter():
        element.tag = element.tag.rsplit("}", 1)[-1]
    return root


def _refuse(source: Source) -> NoReturn:
    raise InputError(
        source.path,
        "found a Sinumerik frequency-response measurement, which holds no motion over time",
        "allowed: a recording of velocity or position and of current or torque over time",
    )


SINUMERIK = FileFormat(
    "Sinumerik frequency response (refused)", (), lambda source: root_name(source).startswith("ResponseTest"), _refuse
)
