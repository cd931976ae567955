"""A page as HTML: one file that opens without any other and without a network, or beside one script file for many."""

from __future__ import annotations

import base64
import hashlib
import json
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from bench.names import plain
from bench.report.page.blocks import File, Page
from bench.report.page.chart import drawn
from bench.report.page.intervals import laid
from bench.report.page.rail import ruler
from bench.report.page.scripted import Motion, TimeGraph


def html(page: Page, script: str | None = None) -> str:
    """The page.

    Args:
        page: what it says.
        script: address, as seen from the page, of the script file that it shares with others; inside of it without.
    """
    blocks = [block for section in page.sections for block in section.blocks]
    lively = any(isinstance(block, TimeGraph | Motion) for block in blocks)
    return (
        _environment()
        .get_template("page.html.j2")
        .render(
            page=page,
            style=Markup(style()),
            script=Markup(program()) if lively and script is None else None,
            shared=script if lively else None,
            policy=_policy(program() if lively and script is None else None),
        )
    )


def program() -> str:
    """uPlot and the page's own scripts, for inside of a page or for a file of its own."""
    own = (_asset("assets", name) for name in ("page.js", "motion.js"))
    return "\n".join((_asset("uplot", "uPlot.iife.min.js"), *own))


def style() -> str:
    """Style sheets of uPlot and of the page."""
    return _asset("uplot", "uPlot.min.css") + "\n" + _asset("assets", "page.css")


@cache
def _asset(*parts: str) -> str:
    return files("bench.report.page").joinpath(*parts).read_text(encoding="utf-8")


@cache
def _environment() -> Environment:
    found = Environment(
        loader=PackageLoader("bench.report.page"), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True, finalize=_shown,
    )  # fmt: skip
    found.filters |= {"data": _data, "link": _link, "drawn": drawn, "laid": laid, "ruler": ruler}
    return found


def _shown(value: Any) -> Any:  # noqa: ANN401 - whatever a template prints
    """Text with the characters written out that would turn the direction of what follows."""
    return plain(value) if type(value) is str else value


def _data(graph: TimeGraph | Motion) -> Markup:
    """A graph or a motion as JSON inside of a script element, which no text in it can end."""
    text = json.dumps(graph.model_dump(), ensure_ascii=True, separators=(",", ":"))
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def _link(file: File) -> str:
    """A file as an address."""
    return f"data:{file.media};base64,{base64.b64encode(file.content.encode()).decode('ascii')}"


def _policy(inside: str | None) -> str:
    """What a browser may do for the page: run this script or one beside it, and load nothing from anywhere."""
    if inside is None:
        scripts = "'self' file:"
    else:
        scripts = f"'sha256-{base64.b64encode(hashlib.sha256(inside.encode()).digest()).decode('ascii')}'"
    return f"default-src 'none'; style-src 'unsafe-inline'; img-src data:; script-src {scripts}; base-uri 'none'"
