"""A result as a document: a headline, answers, and sections of text, tables, charts and files. It is independent of
renderers.

Every command makes one document of its result, in one file of `bench/report`. `bench.report.html`, `terminal`,
`markdown` and `figures` show it, and know no result. It is data, stored next to its page, which can be rendered again
from it (`bench report`). All text in it is text: a name from a file is shown and never executed.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any, Literal

from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, PlainSerializer, model_validator

from bench.arrays import Array

SCHEMA = "bench.page/1"

#: How a headline is meant: all is well, something remains to be done, or the answer is no.
Tone = Literal["sure", "open", "refused"]
#: The meaning of something drawn: what was measured, a model, a residual, noise, or what comes first; and four more.
Colour = Literal["ink", "model", "residual", "floor", "first", "violet", "ochre", "blue", "red"]
#: Of the curves of a chart that stand for nothing of these, in their order.
COLOURS: tuple[Colour, ...] = ("ink", "model", "residual", "violet", "ochre", "blue", "red", "first")
#: How a series is drawn: dots, large ones or rings; a line, full, dashed, dotted or wide; or a band between its bounds.
Style = Literal["dots", "large dots", "rings", "line", "dashes", "dotted", "wide", "band"]
#: How many times slower than it was a motion plays.
Slowed = Literal[1, 2, 5, 10, 20, 50, 100]


class Part(BaseModel):
    """A part of a document: frozen, and an unknown key in it is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True)


#: Largest number that a drawing has a place for; of a logarithmic one the smallest is its inverse.
LARGEST = 1e100
#: A file near the page, by its path from there, or a part of the page: it leads to no other machine.
Address = Annotated[
    str, Field(pattern=r"^((\.\./)*([A-Za-z0-9_][A-Za-z0-9_.-]*/)*([A-Za-z0-9_][A-Za-z0-9_.-]*)?|#[a-z]+-[0-9]+)$")
]


def _require(right: bool, allowed: str) -> None:
    """What its parts cannot check themselves, of a document that is read back."""
    if not right:
        raise ValueError(allowed)


class Paragraph(Part):
    """A paragraph of text."""

    kind: Literal["paragraph"] = "paragraph"
    text: str


class Points(Part):
    """A list of short texts."""

    kind: Literal["points"] = "points"
    items: tuple[str, ...]


def points(items: Iterable[str]) -> Points:
    """A list of these texts."""
    return Points(items=tuple(items))


class Code(Part):
    """Lines of a file to write, or of a command, as they stand."""

    kind: Literal["code"] = "code"
    text: str


class Heading(Part):
    """Of a column of a table: of numbers, which are set to the right, or of sentences (`prose`), which need room."""

    heading: str
    number: bool = False
    prose: bool = False


class Series(Part):
    """What is drawn into a chart, under its name in the legend, in the colour of its meaning.

    Attributes:
        x, y: points (b,); `y` is () of a band.
        low, high: of a band, or of an interval around each dot (b,); () without.
    """

    name: str
    style: Style
    colour: Colour
    x: tuple[float, ...]
    y: tuple[float, ...] = ()
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()

    @model_validator(mode="after")
    def _is_whole(self) -> Series:
        lengths = {len(values) for values in (self.y, self.low, self.high) if values}
        _require(lengths <= {len(self.x)} and bool(self.low) == bool(self.high), "as many values as places")
        return self


def series(
    name: str, style: Style, colour: Colour, x: Array, y: Array | None = None, bounds: tuple[Array, Array] | None = None
) -> Series:
    """A series of arrays: points `x`, `y` (b,), and what lies below and above of each (b,)."""
    found = {key: tuple(map(float, values)) for key, values in (("x", x), ("y", y)) if values is not None}
    low, high = ((), ()) if bounds is None else (tuple(map(float, bound)) for bound in bounds)
    return Series(name=name, style=style, colour=colour, low=low, high=high, **found)


class Table(Part):
    """A table: the first cell of a row names it.

    Attributes:
        marked: numbers of rows to be noticed.
        links: where the names of rows lead to, a page or a part of this one, "" for none; () without.
        sketches: what is drawn small into the second cell of each row, without axes; () without.
        sought: whether a reader can seek rows by words.
        folded: whether a page shows only its caption until a reader opens it.
    """

    kind: Literal["table"] = "table"
    caption: str
    columns: tuple[Heading, ...]
    rows: tuple[tuple[str, ...], ...]
    marked: tuple[int, ...] = ()
    links: tuple[Address, ...] = ()
    sketches: tuple[tuple[Series, ...], ...] = ()
    sought: bool = False
    folded: bool = False

    @model_validator(mode="after")
    def _is_whole(self) -> Table:
        _require(all(len(row) == len(self.columns) for row in self.rows), "a cell for each column in every row")
        counts = {len(each) for each in (self.links, self.sketches) if each}
        _require(counts <= {len(self.rows)}, "a link and a sketch for every row, or for none")
        return self


def table(
    caption: str, headings: Sequence[str], rows: Iterable[Iterable[str | None]], marked: Iterable[int] = ()
) -> Table:
    """A table; `>` behind a heading sets its cells to the right, as numbers are, `~` gives sentences room.

    A cell that is None is a dash.
    """
    columns = tuple(
        Heading(heading=one.removesuffix(">").removesuffix("~"), number=one.endswith(">"), prose=one.endswith("~"))
        for one in headings
    )
    cells = tuple(tuple("–" if cell is None else cell for cell in row) for row in rows)
    return Table(caption=caption, columns=columns, rows=cells, marked=tuple(marked))


class Panel(Part):
    """One pair of axes of a chart.

    Attributes:
        note: in its corner.
        y_label: of the vertical axis with its unit, where it is no other panel's.
        log: whether both axes are logarithmic.
        counted: whether x is a number of a count, so that its axis has whole ones.
        bins: which point of the first series with dots each interval of the page's first graph over time belongs to,
            -1 of none, as 16-bit numbers in base 64; None of points that are no bins of a recording.
    """

    x_label: str
    x_unit: str = ""
    note: str = ""
    series: tuple[Series, ...]
    y_label: str = ""
    log: bool = False
    counted: bool = False
    bins: str | None = None


class Drawing(Part):
    """What is drawn: its title, and what it shows in words."""

    title: str
    alternative: str


class Chart(Drawing):
    """Panels of points and lines over anything; drawn without a script.

    Panels are next to each other and share one y scale; those that have y labels stand one above the other, with
    a scale each, and on a page next to each other where they are `narrow`.
    """

    kind: Literal["chart"] = "chart"
    narrow: bool = False
    y_label: str = ""
    y_unit: str = ""
    panels: tuple[Panel, ...] = Field(min_length=1)

    @property
    def stacked(self) -> bool:
        """Whether its panels stand one above the other."""
        return any(panel.y_label for panel in self.panels)


class Span(Part):
    """A row of intervals, coloured as a series: a value and its bounds, low <= value <= high."""

    name: str
    colour: Colour
    value: float
    low: float
    high: float


class Intervals(Drawing):
    """Intervals below each other on one scale, a row each (a forest plot); drawn without a script.

    Attributes:
        label, unit: of the scale.
        right: values between which all is as it should be: a band behind all rows, or a line.
        limits: of the scale; what lies beyond is drawn at its end, as a ring.
        spans: from top to bottom.
        log: whether the scale is logarithmic.
    """

    kind: Literal["intervals"] = "intervals"
    label: str
    unit: str = ""
    right: tuple[float, float]
    limits: tuple[float, float]
    spans: tuple[Span, ...]
    log: bool = False

    @model_validator(mode="after")
    def _has_a_scale(self) -> Intervals:
        least = 1.0 / LARGEST if self.log else -LARGEST
        _require(
            least <= self.limits[0] < self.limits[1] <= LARGEST, "limits that a scale can have, the lower one first"
        )
        return self


class HeatMap(Part):
    """Counts as a table whose cells are coloured by their share of the row; drawn without a script.

    Attributes:
        corner: what rows are.
        rows, columns: headings.
        counts: a row each; zero is blank. All should lie on the diagonal, which is framed.
    """

    kind: Literal["heat"] = "heat"
    caption: str
    corner: str
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    counts: tuple[tuple[int, ...], ...]

    @model_validator(mode="after")
    def _is_whole(self) -> HeatMap:
        whole = len(self.counts) == len(self.rows) and all(len(row) == len(self.columns) for row in self.counts)
        _require(whole, "a count for each row and column")
        return self


def packed(values: NDArray[Any], kind: str = "<f4") -> str:
    """Numbers of any shape in base 64: 32-bit floats, or of another kind as NumPy has it."""
    return base64.b64encode(values.astype(kind).tobytes()).decode("ascii")


class Samples(Part):
    """A curve on the grid of its graph, or at the instants of a motion, in 16 bits; see `bench.report.over_time`.

    Attributes:
        offset, scale: a value is offset + scale*number.
        low, high: numbers in base 64; `high` is None where each interval has one value.
    """

    offset: float
    scale: float
    low: str
    high: str | None


class TimeCurve(Part):
    """A curve over time, drawn by its role; shown where its graph's choice is `choice`, always where that is None."""

    name: str
    role: Literal["measured", "model", "residual"]
    choice: int | None
    samples: Samples


class TimePanel(Part):
    """Curves over one y axis; `first`: whether those of the first choice stay in sight with another one's."""

    label: str
    unit: str
    curves: tuple[TimeCurve, ...]
    first: bool = False


class TimeGraph(Drawing):
    """Panels from top to bottom over one time axis that zoom, pan and hover together.

    Attributes:
        start, step, count: of the grid of its curves - s.
        choices: models to choose from, the last one first in sight.
    """

    kind: Literal["time"] = "time"
    start: float
    step: float = Field(gt=0.0)
    count: int = Field(gt=0)
    choices: tuple[str, ...] = ()
    panels: tuple[TimePanel, ...]


class Triangles(Part):
    """Triangles of one colour: x of all vertices, then y, then z - m -, and the three vertices of each face."""

    colour: tuple[float, ...]
    vertices: Samples
    faces: Samples


class Pivot(Part):
    """A joint of a body: its axis and a point of it in the body's frame - m -, and its zero - rad (m).

    `of`: whose position it has: 0 of the motion, then of a robot's poses; None of none, it is fixed.
    """

    of: int | None
    axis: tuple[float, ...]
    anchor: tuple[float, ...]
    slides: bool
    zero: float


class Body(Part):
    """A body of a robot: the number of that which carries it, its frame there - m, quaternion -, joints and shapes."""

    parent: int
    place: tuple[float, ...]
    turn: tuple[float, ...]
    joints: tuple[Pivot, ...]
    shapes: tuple[Triangles, ...]


class RobotDrawing(Part):
    """What moves with the joint that a motion is of, whose motor turns `ratio` times as far.

    Attributes:
        bodies: the first is fixed, the others come after the one that carries them.
        ratio: of the joint's gear.
        start, step: of the instants of the poses - s.
        poses: of the other joints - rad (m).
    """

    bodies: tuple[Body, ...]
    ratio: float
    start: float
    step: float = Field(gt=0.0)
    poses: tuple[Samples, ...]


class ModelRun(Part):
    """How a model was run, and its position less that of the ghost at the instants of the motion.

    `others`: the same of a robot's other joints at the instants of its poses, where they have models, too.
    """

    name: str
    apart: Samples
    others: tuple[Samples, ...] = ()


class Moving(Drawing):
    """An axis in motion, with the one it is compared with as a ghost: a disk, a slide on its rail, or a robot.

    Attributes:
        turns: whether the axis does.
        unit: of its position.
        ghost: what the ghost is.
        start, step, count: of the instants - s.
        low, high: between which it is drawn, where it does not turn.
        slowed: how many times slower than the motion it plays at first.
        position: of the ghost: 32-bit floats in base 64, nan where unknown.
        runs: of the model, to choose from.
        robot: that the axis is a joint of.
    """

    kind: Literal["motion"] = "motion"
    turns: bool
    unit: str
    ghost: str
    start: float
    step: float = Field(gt=0.0)
    count: int = Field(gt=1)
    low: float
    high: float
    slowed: Slowed = 1
    position: str
    runs: tuple[ModelRun, ...] = Field(min_length=1)
    robot: RobotDrawing | None = None


class File(Part):
    """A file to take along, under its name and media type: inside of the page, and next to it in a command's folder."""

    name: str
    about: str
    media: str
    content: str


#: Media types of files to take along, by the endings of their names.
MEDIA = {
    "json": "application/json",
    "md": "text/markdown",
    "py": "text/x-python",
    "svg": "image/svg+xml",
    "toml": "application/toml",
    "xml": "application/xml",
}


class Downloads(Part):
    """Files to take along."""

    kind: Literal["downloads"] = "downloads"
    files: tuple[File, ...]


def file(name: str, about: str, content: str) -> File:
    """A file to take along, whose name's ending is one of `MEDIA`."""
    return File(name=name, about=about, media=MEDIA[name.rpartition(".")[2]], content=content)


def downloads(*files: File) -> Downloads:
    """These files to take along."""
    return Downloads(files=files)


class Neighbour(Part):
    """A file near the page, by its path from there; `about`: what it is."""

    name: Address
    about: str


class Neighbours(Part):
    """Links to files next to the page."""

    kind: Literal["neighbours"] = "neighbours"
    files: tuple[Neighbour, ...]


def neighbours(files: Mapping[str, str]) -> Neighbours:
    """Links to files by their names, and what they are."""
    return Neighbours(files=tuple(Neighbour(name=name, about=about) for name, about in files.items()))


AnyPart = Annotated[
    Paragraph | Points | Code | Table | TimeGraph | Moving | Chart | Intervals | HeatMap | Downloads | Neighbours,
    Field(discriminator="kind"),
]
#: What a picture can hold.
Drawable = Table | TimeGraph | Chart | Intervals | HeatMap


class Section(Part):
    """A section under a heading; `key`: its anchor on the page, `detail`: whether only the page shows it."""

    key: str = Field(pattern=r"^[a-z][a-z0-9-]*$")
    heading: str
    blocks: tuple[AnyPart, ...]
    detail: bool = Field(default=False, exclude=True)


def section(key: str, heading: str, *blocks: AnyPart, detail: bool = False) -> Section:
    """A section of these parts."""
    return Section(key=key, heading=heading, blocks=blocks, detail=detail)


def sections(*given: Section) -> tuple[Section, ...]:
    """Those of these that hold anything."""
    return tuple(one for one in given if one.blocks)


class Picture(Part):
    """A figure for paper, by its file's name without ending: rows from top to bottom, their parts next to each
    other."""

    name: str
    title: str
    rows: tuple[tuple[Drawable, ...], ...]


def _answers(given: Any) -> Any:  # noqa: ANN401 - any content of a file
    """Answers by question: of the list that a file has, or as they are."""
    try:
        return {one["question"]: one["answer"] for one in given}
    except (KeyError, TypeError):
        return given


Answers = Annotated[
    Mapping[str, str],
    BeforeValidator(_answers),
    PlainSerializer(lambda answers: [{"question": key, "answer": value} for key, value in answers.items()]),
]


class Document(Part):
    """A result.

    Attributes:
        title: of the window.
        subject: what it is about: rig and recordings.
        verdict, tone: the headline, a sentence.
        answers: what a reader wants to know first, by question.
        glance: what shows it best, drawn below the answers next to each other.
        origin: version and digests, on which it is based.
        pictures: figures for paper, which are no part of the page.
        files_in_folder: texts of files by their names, which lie in its folder and are no part of the page.
        warnings: what a user should know before relying on it, for standard error; the page has them in a section.
    """

    page: Literal["bench.page/1"] = SCHEMA
    title: str
    subject: str
    verdict: str
    tone: Tone
    answers: Answers
    glance: tuple[Chart, ...] = ()
    sections: tuple[Section, ...]
    origin: tuple[str, ...] = ()
    pictures: tuple[Picture, ...] = Field(default=(), exclude=True)
    files_in_folder: Mapping[str, str] = Field(default_factory=dict, exclude=True)
    warnings: tuple[str, ...] = Field(default=(), exclude=True)

    @property
    def blocks(self) -> tuple[AnyPart, ...]:
        """All parts of its sections."""
        return tuple(block for section in self.sections for block in section.blocks)

    @property
    def files(self) -> tuple[File, ...]:
        """Files to take along."""
        return tuple(file for block in self.blocks if isinstance(block, Downloads) for file in block.files)
