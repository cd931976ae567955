"""The blocks of a page. A page is data, stored with its HTML, which can be regenerated from it (`bench report`).

All text in it is text: a name from a file is shown, whatever it holds, and never obeyed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field

from bench.report.page.block import Block
from bench.report.page.scripted import Motion, TimeGraph

SCHEMA = "bench.page/1"

#: How a verdict is meant: all is well, something is left to do, or the answer is no.
Tone = Literal["sure", "open", "refused"]
#: What something drawn stands for: what was measured, a model, what is left, noise, or what comes first.
Colour = Literal["ink", "model", "left", "floor", "first"]


class Paragraph(Block):
    """A paragraph of text."""

    kind: Literal["paragraph"] = "paragraph"
    text: str


class Points(Block):
    """A list of short texts."""

    kind: Literal["points"] = "points"
    items: tuple[str, ...]


class Column(Block):
    """A column of a table.

    Attributes:
        heading: of it.
        number: whether it holds numbers, which are set to the right.
        prose: whether it holds sentences, which need room.
    """

    heading: str
    number: bool = False
    prose: bool = False


class Table(Block):
    """A table.

    Attributes:
        caption: what it tells.
        columns, rows: of it; the first cell of a row names it.
        marked: rows to be noticed, by their numbers.
    """

    kind: Literal["table"] = "table"
    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]
    marked: tuple[int, ...] = ()


class Series(Block):
    """What is drawn into a chart.

    Attributes:
        name: of it, for the legend.
        style: dots, rings, a line, or a band between `low` and `high`.
        colour: by what it stands for: what was measured, a model, what is left, noise, or what comes first.
        x, y: points (b,); `y` is () of a band.
        low, high: of a band, or of an interval around each dot (b,); () without.
    """

    name: str
    style: Literal["dots", "rings", "line", "band"]
    colour: Colour
    x: tuple[float, ...]
    y: tuple[float, ...] = ()
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()


class Axes(Block):
    """One panel of a chart; `note` stands in its corner."""

    x_label: str
    x_unit: str = ""
    note: str = ""
    series: tuple[Series, ...]


class Chart(Block):
    """Panels of points and lines over anything, on one y scale; drawn without a script.

    Attributes:
        title: of the chart.
        alternative: what it shows, in words.
        y_label, y_unit: of all panels.
        panels: of it.
    """

    kind: Literal["chart"] = "chart"
    title: str
    alternative: str
    y_label: str
    y_unit: str = ""
    panels: tuple[Axes, ...]


class Span(Block):
    """A row of intervals: a value and its bounds.

    Attributes:
        name: of it.
        colour: by what it stands for, as of a series.
        value, low, high: of it, low <= value <= high.
    """

    name: str
    colour: Colour
    value: float
    low: float
    high: float


class Intervals(Block):
    """Intervals below each other on one scale, a row each (a forest plot); drawn without a script.

    Attributes:
        title: of the chart.
        alternative: what it shows, in words.
        label, unit: of the scale.
        right: values between which all is as it should be: a band behind all rows, or a line.
        limits: of the scale; what lies beyond is drawn at its end, as a ring.
        spans: from top to bottom.
    """

    kind: Literal["intervals"] = "intervals"
    title: str
    alternative: str
    label: str
    unit: str = ""
    right: tuple[float, float]
    limits: tuple[float, float]
    spans: tuple[Span, ...]


class HeatMap(Block):
    """Counts as a table whose cells are coloured by their share of the row; drawn without a script.

    Attributes:
        caption: what it tells.
        corner: what rows are.
        rows, columns: headings.
        counts: a row each; zero is left blank. All should lie on the diagonal, which is framed.
    """

    kind: Literal["heat"] = "heat"
    caption: str
    corner: str
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    counts: tuple[tuple[int, ...], ...]


class File(Block):
    """A file inside the page.

    Attributes:
        name: under which it is saved.
        about: what it is.
        media: its type.
        content: its text.
    """

    name: str
    about: str
    media: str
    content: str


class Downloads(Block):
    """Files to take along."""

    kind: Literal["downloads"] = "downloads"
    files: tuple[File, ...]


class Neighbour(Block):
    """A file in the folder of the page, by its name; `about`: what it is."""

    name: str = Field(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$")
    about: str


class Neighbours(Block):
    """Links to files beside the page."""

    kind: Literal["neighbours"] = "neighbours"
    files: tuple[Neighbour, ...]


AnyBlock = Annotated[
    Paragraph | Points | Table | TimeGraph | Motion | Chart | Intervals | HeatMap | Downloads | Neighbours,
    Field(discriminator="kind"),
]


class Section(Block):
    """A section under a heading; `key` is its anchor on the page."""

    key: str = Field(pattern=r"^[a-z][a-z0-9-]*$")
    heading: str
    blocks: tuple[AnyBlock, ...]


class Answer(Block):
    """A question that a reader comes with, and what the page has to say to it."""

    question: str
    answer: str


def answered(answers: Mapping[str, str]) -> tuple[Answer, ...]:
    """Questions with their answers, as a page lists them."""
    return tuple(Answer(question=question, answer=answer) for question, answer in answers.items())


class Page(Block):
    """A report.

    Attributes:
        title: of the window.
        subject: what it is about: rig and recordings.
        verdict: in a sentence.
        tone: of it.
        answers: what a reader wants to know first.
        sections: the rest.
        origin: version and digests, so that anybody can tell what it rests on.
    """

    page: Literal["bench.page/1"] = SCHEMA
    title: str
    subject: str
    verdict: str
    tone: Tone
    answers: tuple[Answer, ...]
    sections: tuple[Section, ...]
    origin: tuple[str, ...] = ()
