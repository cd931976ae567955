"""A check: whether an axis has changed, what did, by how many margins, and how sure that is.

In sentences, as the contract's JSON (`bench.check/1`), and as a document.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from bench.baseline.check import Checked
from bench.baseline.model import RESPONSE_TORQUE
from bench.baseline.state import GAPS, AxisEffect, RemainingGap
from bench.comparison.difference import CHANGED, SAME, UNDECIDED, Comparison
from bench.names import short, words
from bench.report import document as doc
from bench.report.numbers import effort_word, number, sentence, share, unit_text
from bench.report.serial import as_json, known, picked, serialised

SCHEMA = "bench.check/1"
#: Units shown in another one, with the factor.
DISPLAYED = {"rad": ("deg", 180.0 / math.pi)}
#: Quantities that change as a consequence of others.
FOLLOWING = frozenset({*GAPS, RESPONSE_TORQUE})
COLOURS: dict[str, doc.Colour] = {CHANGED: "model", UNDECIDED: "ink", SAME: "residual"}
TONES: dict[str, doc.Tone] = {SAME: "sure", UNDECIDED: "open", CHANGED: "refused"}
#: What to do next, by the result; and by what keeps it undecided.
NEXT = {
    CHANGED: "Look at what changed; where the new state is right, accept it with --update.",
    SAME: "Nothing.",
    "rig": "Make a new baseline: --update with recordings of the old state and the rig file of now.",
    "conditions": "Record the motion of the baseline at its sampling, and check again.",
    UNDECIDED: "Record again, several times: a difference near its margin needs more than one recording to decide.",
}
#: Margins to which the chart reaches at least, so that one is seen, and at most, so that small differences are.
LEAST, MOST = 2.0, 8.0
#: Characters of what a state is based on, and of a title of file names.
LONG = 600


def check_json(checked: Checked) -> str:
    """The check as the contract's JSON."""
    baseline, now = checked.baseline, checked.now
    gaps = {}
    for name, unit, *both in _gaps(checked):
        was, remains = (gap and {key: getattr(gap, key).value for key in ("after", "noise_floor")} for gap in both)
        gaps[name] = {"unit": unit, "baseline": was, "now": remains}
    return serialised(
        {
            "schema": SCHEMA,
            "result": checked.result,
            "says": headline(checked),
            "false_alarm_rate": checked.false_alarm_rate,
            "comparisons": checked.family,
            "quantities": [one for one in checked.comparisons if not one.effect],
            "effects": {name: [_effect(*pair) for pair in getattr(checked, name)] for name in ("appeared", "gone")},
            "verdict": {"baseline": baseline.verdict or None, "now": now.verdict or None},
            "gap": gaps,
            **picked(checked, "rig", "conditions"),
            "provenance": {**now.provenance, "baseline": baseline.provenance},
        }
    )


@as_json.register
def _(one: Comparison) -> dict[str, Any]:
    return {
        **picked(one, "name", "unit", "baseline", "now", "difference95"),
        "std_error": None if one.difference is None else one.difference.std_error,
        **picked(one, "margin", "chance", "result"),
        "because": one.reason or None,
    }


def _effect(effect: AxisEffect, one: Comparison) -> dict[str, Any]:
    """An effect that came or went; how sure that is: its torque against what the other state would have shown."""
    parameters = {
        key: {**picked(found, "value", "unit"), "std_error": known(found.std_error)}
        for key, found in effect.quantities.items()
    }
    torque = picked(one, "unit", "baseline", "now", "margin") if one.unit else None
    return {
        "name": effect.name,
        "parameters": parameters,
        "ambiguous_with": effect.ambiguous_with,
        "result": one.result,
        "because": one.reason or None,
        "evidence": {"torque": torque, "chance": one.chance, "gain": effect.gain},
    }


def _gaps(checked: Checked) -> Iterator[tuple[str, str, RemainingGap | None, RemainingGap | None]]:
    """Name and unit of each gap, then and now."""
    before, now = checked.baseline.gaps, checked.now.gaps
    for name in dict.fromkeys([*before, *now]):
        yield name, (now.get(name) or before[name]).after.unit, before.get(name), now.get(name)


def headline(checked: Checked, brief: bool = False) -> str:
    """What changed, in one line; or that nothing did, or why it is undecided; `brief`: of effects their names alone."""
    if checked.result == CHANGED:  # names, then parameters; gaps only if nothing else did
        changed = [one for one in checked.comparisons if one.result == CHANGED]
        changed.sort(key=lambda one: not one.effect)
        *first, last = (
            described(one, checked, brief) for one in [one for one in changed if one.name not in FOLLOWING] or changed
        )
        return sentence(f"{', '.join(first)}, and {last}" if first else last)
    if checked.result == SAME:
        return "The same: no quantity differs by more than its margin"
    if checked.rig:
        return f"Undecided, as the rig differs: {'; '.join(checked.rig)}"
    open_ = [described(one, checked, brief) for one in checked.comparisons if one.result != SAME]
    if checked.baseline.verdict != checked.now.verdict:
        verdicts = (words(one) for one in (checked.baseline.verdict, checked.now.verdict))
        open_.append(f"the verdict is {' -> '.join(verdicts)}")
    motion = [f"motion or sampling differ ({', '.join(checked.conditions)})"] if checked.conditions else []
    return f"Undecided: {'; '.join([*motion, *open_])}"


def described(one: Comparison, checked: Checked, brief: bool = False) -> str:
    """One comparison in words; `brief`: of an effect its name alone."""
    label = words(one.name).replace(".", " ")
    effect = next((effect for effect, found in (*checked.appeared, *checked.gone) if found is one), None)
    if effect is not None:
        came, went = ("appeared", "is gone") if one.result == CHANGED else ("is named now", "is named no more")
        line, had = (f"{label} {came}", "") if one.effect == "appeared" else (f"{label} {went}", ", which had")
        return line if brief else f"{line}{had}: {_values(effect)}{_why(one)}"
    if one.baseline is None or one.now is None:
        return f"{label} cannot be compared{_why(one)}"
    before, after = shown(one.baseline, one.unit, named=False), shown(one.now, one.unit)
    share = f" ({100.0 * (one.now / one.baseline - 1.0):+.3g} %)".replace("-", "−") if one.baseline else ""
    if one.result == CHANGED:
        return f"{label} {'rose' if one.now > one.baseline else 'fell'} from {before} to {after}{share}"
    if brief:
        return f"{label} may have changed{share}"
    how = "is the same:" if one.result == SAME else "may have changed:"
    return f"{label} {how} {before} and now {after}{share}{_why(one)}"


def _why(one: Comparison) -> str:
    """Why a comparison is undecided, or how certain it is that an effect appeared."""
    if one.effect == "appeared" and one.differences and not one.held_back:
        seen = "would have shown" if one.result == CHANGED else "may have hidden"
        return f" ({shown(one.now or 0.0, one.unit)} RMS, where the baseline {seen} {shown(one.margin, one.unit)})"
    return f", but {one.reason}" if one.reason else ""


def _values(effect: AxisEffect) -> str:
    """Quantities of an effect, without angles, whose zero is arbitrary, and without those in its label."""
    counted = {slot.quantity.name for slot, _ in effect.whole}
    names = [q.name for q in effect.effect.quantities if not q.angle and q.name not in counted]
    values = ((name, effect.quantities[name]) for name in names)
    return ", ".join(f"{words(name)} {shown(of.value, of.unit)}" for name, of in values)


def shown(value: float, unit: str, named: bool = True) -> str:
    """A number in the unit for display; `named`: with that behind it."""
    called, factor = DISPLAYED.get(unit, (unit, 1.0))
    return f"{value * factor:.4g}" + (f" {called}" if named and called != "dimensionless" else "")


def check_document(checked: Checked, title: str) -> doc.Document:
    """The document of a check of what `title` names."""
    alike, line = not (checked.rig or checked.conditions), unit_text(headline(checked, brief=True))
    gaps = [_gaps_table(checked)] if checked.baseline.gaps or checked.now.gaps else []
    return doc.Document(
        title=f"{short(title)}: check",
        subject=short(title, LONG),
        verdict=f"Changed: {line}." if checked.result == CHANGED else f"{line}.",
        tone=TONES[checked.result],
        answers=_answers(checked),
        sections=doc.sections(
            doc.section("comparisons", "What was compared", *_compared(checked)),
            doc.section("runs", "Over the runs", *_runs_chart(checked)),
            doc.section("conditions", "Like with like", _unlike(checked), detail=alike),
            doc.section("gaps", "Residuals of the models", *gaps, detail=True),
        ),
        origin=(_basis("now", checked.now.provenance), _basis("baseline", checked.baseline.provenance)),
    )


def _answers(checked: Checked) -> dict[str, str]:
    results, pairs = [one.result for one in checked.comparisons], [*checked.appeared, *checked.gone]
    if pairs:
        came = unit_text(sentence("; ".join(described(one, checked) for _, one in pairs))) + "."
    elif not (checked.baseline.names and checked.now.names):
        came = "Not checked: the baseline has only parameters."
    else:
        kept = ", ".join(words(effect.label) for effect in checked.now.effects)
        came = f"No effect; {kept} as in the baseline." if kept else "No effect: none is named in either state."
    sure = f"False-alarm rate: at most {share(checked.false_alarm_rate)} over all {checked.family} comparisons."
    count = ", ".join(f"{results.count(result)} {result}" for result in TONES if result in results)
    held_up = "rig" if checked.rig else "conditions" if checked.conditions else UNDECIDED
    return {
        "What came or went?": came,
        "How many differ?": f"{count} of {len(results)} comparisons." if results else "Nothing could be compared.",
        "How sure?": sure if checked.false_alarm_rate else "The values of two models are exact, without noise.",
        "What next?": NEXT[held_up if checked.result == UNDECIDED else checked.result],
    }


def _compared(checked: Checked) -> Iterator[doc.AnyPart]:
    """The chart, and the table behind it, worst first."""
    spans = []
    for one in checked.comparisons:
        bounds, difference = one.difference95, one.difference
        if bounds is not None and difference is not None and one.margin > 0.0:
            low, value, high = (each / one.margin for each in (bounds[0], difference.value, bounds[1]))
            spans.append(doc.Span(name=_label(one), colour=COLOURS[one.result], value=value, low=low, high=high))
    if spans:
        reach = max(abs(end) for span in spans for end in (span.low, span.high))
        reach = min(max(reach, LEAST), MOST)
        yield doc.Intervals(
            title="Differences over their margins.",
            alternative="Now less baseline with its interval of 95 %, as a multiple of the margin: within the band "
            f"it does not matter. A ring at the end of the scale lies beyond {number(reach, digits=2)} margins.",
            label="difference over margin",
            right=(-1.0, 1.0),
            limits=(-reach, reach),
            spans=tuple(spans),
        )
    because = any(one.reason for one in checked.comparisons)
    headings = ("quantity", "baseline>", "now>", "difference (95 %)>", "margin>", "unit", "result")
    rows = ((*_cells(one), *([unit_text(one.reason)] if because else [])) for one in checked.comparisons)
    marked = (k for k, one in enumerate(checked.comparisons) if one.result == CHANGED)
    yield doc.table("Worst first", (*headings, *(["because~"] if because else [])), rows, marked)


def over_runs(checked: Checked) -> dict[str, doc.Panel]:
    """Each quantity over the runs, worst first: its baseline and margin, and the value now with its interval."""
    if checked.baseline.source == "model":
        return {}
    return {one.name: _run_panel(checked, one) for one in checked.comparisons if one.differences and one.margin > 0.0}


def _run_panel(checked: Checked, one: Comparison) -> doc.Panel:
    """Runs of the baseline, then those that are judged; the interval is that of the difference, from the baseline."""
    unit, factor = DISPLAYED.get(one.unit, (one.unit, 1.0))
    states = [state.quantities.get(one.name) for state in (checked.baseline, checked.now)]
    counts = [1 if state is None else state.recordings for state in states]
    before, after = (() if state is None else tuple(factor * value for value in state.each) for state in states)
    runs, edges, colour = np.arange(1.0, sum(counts) + 1.0), np.array([0.5, sum(counts) + 0.5]), COLOURS[one.result]
    level, band = np.full(2, factor * (one.baseline or 0.0)), factor * one.margin
    drawn = [
        doc.series("baseline ± margin", "band", "floor", edges, bounds=(level - band, level + band)),
        doc.series("baseline", "dashes", "ink", edges, level),
    ]
    if len(before) == counts[0]:
        drawn.append(doc.series("its runs", "dots", "ink", runs[: counts[0]], np.array(before)))
    if len(after) == counts[1] > 1:
        drawn.append(doc.series("runs now", "rings", colour, runs[counts[0] :], np.array(after)))
    judged, low, high = ([factor * value] for value in (one.now or 0.0, *(one.difference95 or (0.0, 0.0))))
    bounds = level[:1] + low, level[:1] + high
    at = runs[counts[0] :].mean(keepdims=True)
    drawn.append(doc.series("judged, with its interval", "large dots", colour, at, np.array(judged), bounds))
    label = f"{_label(one)} / {unit_text(unit)}" if unit != "dimensionless" else _label(one)
    return doc.Panel(x_label="run", counted=True, note=one.result, y_label=label, series=tuple(drawn))


def _runs_chart(checked: Checked) -> Iterator[doc.Chart]:
    panels = tuple(over_runs(checked).values())
    if panels:
        yield doc.Chart(
            title="Each quantity over the runs, worst first.",
            alternative="A quantity has changed where the interval of 95 % is clearly outside the band.",
            narrow=True,
            panels=panels,
        )


def _label(one: Comparison) -> str:
    return words(one.name).replace(".", ": ") + (f", {one.effect}" if one.effect else "")


def _cells(one: Comparison) -> tuple[str, ...]:
    """A comparison as a row: quantity, baseline, now, difference, margin, unit, result."""

    def text(value: float | None) -> str:
        return "−" if value is None else shown(value, one.unit, named=False).replace("-", "−")

    unit, bounds = unit_text(DISPLAYED.get(one.unit, (one.unit,))[0]), one.difference95
    difference = "−" if bounds is None else f"{text(bounds[0])} to {text(bounds[1])}"
    margin = text(None if bounds is None else one.margin)
    return _label(one), text(one.baseline), text(one.now), difference, margin, unit, one.result


def _unlike(checked: Checked) -> doc.Points | doc.Paragraph:
    """In what the two states are not recorded alike."""
    lines = [f"rig: {line}" for line in checked.rig]
    lines += [f"not as in the baseline: {line}" for line in checked.conditions]
    if lines:
        return doc.points(map(unit_text, lines))
    if not checked.now.conditions:
        return doc.Paragraph(text="The two models are compared: neither is fitted to a recording here.")
    return doc.Paragraph(text="The rig, the motion and the sampling are those of the baseline.")


def _gaps_table(checked: Checked) -> doc.Table:
    """The residuals of both states, and their verdicts."""
    rows: list[tuple[str | None, ...]] = [
        ("verdict", *(words(state.verdict) or "not checked" for state in (checked.baseline, checked.now)), "")
    ]
    for name, unit, *gaps in _gaps(checked):
        what = effort_word(unit) if name == "torque" else words(name)
        for of, value in (("residual", "after"), ("noise floor", "noise_floor")):
            both = (None if gap is None else number(getattr(gap, value).value, digits=3) for gap in gaps)
            rows.append((f"{what}, {of} (RMS)", *both, unit_text(unit)))
    caption = "Verdicts, and what inertia, friction and effects do not explain"
    return doc.table(caption, ("of", "baseline>", "now>", "unit"), rows)


def _basis(label: str, provenance: Mapping[str, Any]) -> str:
    """What a state is based on, with any content of its baseline file."""
    return short(f"{label}: {', '.join(_leaves('', provenance))}", LONG)


def _leaves(name: str, value: object) -> Iterator[str]:
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _leaves(str(key), inner)
    elif isinstance(value, list):
        for inner in value:
            yield from _leaves(name, inner)
    elif value is not None:
        yield f"{words(name)} {value}"
