"""A diagnosis as JSON (contract `bench.diagnose/1`), as a table, and as the folder it leaves."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich import box
from rich.table import Table

from bench.axis_kind import KINDS
from bench.diagnosis.add.same_axis import SameAxis
from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.found import Gap, Shrunk
from bench.diagnosis.where.where import Where
from bench.files import held, write_text
from bench.names import words
from bench.plant.model_file import model_toml, model_xml, tables_toml
from bench.report.diagnosis_figures import gaps_figure, where_figure
from bench.report.document import File
from bench.report.figures import save
from bench.report.gate import checks_json
from bench.report.identification import recordings_json
from bench.report.pages.diagnosis import diagnosis_page
from bench.report.publish import write_document
from bench.report.serial import as_json
from bench.structured import json_text

SCHEMA = "bench.diagnose/1"
#: Between rows of the motion to record next - s.
PERIOD = 1e-3


def diagnosis_json(diagnosis: Diagnosis, provenance: Mapping[str, Any] | None = None) -> str:
    """The diagnosis as the contract's JSON.

    Args:
        diagnosis: what was found.
        provenance: of the files it came from (`bench.report.provenance`); null where it came from none.
    """
    content = {
        "schema": SCHEMA,
        "verdict": diagnosis.verdict,
        "because": diagnosis.because,
        "effects": [
            {
                "name": effect.name,
                "kind": effect.effect.kind,
                "parameters": as_json(effect.parameters),
                "ambiguous_with": list(effect.ambiguous_with),
                "evidence": dict(effect.evidence),
            }
            for effect in diagnosis.effects
        ],
        "where": [_where(account) for account in diagnosis.where],
        "unexplained": {
            "share": diagnosis.unexplained_share,
            "where": [_where(account) for account in diagnosis.unexplained_where],
        },
        "parameters": as_json(diagnosis.parameters),
        **as_json(recordings_json(diagnosis.recordings, diagnosis.between, provenance)),
        "gap": {"torque": _gap(diagnosis.torque), "velocity": _velocity_gap(diagnosis)},
        "steps": [_step(step) for step in diagnosis.steps[1:]],
        "rejected": [{"name": found.name, "reason": found.reason} for found in diagnosis.rejected],
        "holdout": _same_axis(diagnosis.holdout),
        "next_experiment": _experiment(diagnosis),
        "stopped": diagnosis.stopped,
        "provenance": provenance,
        "model": {"mjcf": "model.xml" if diagnosis.model is not None else None, "toml": "model.toml"},
        "checks": checks_json(diagnosis.checks),
        "warnings": diagnosis.warnings,
    }
    return json_text(content)


def _where(account: Where) -> dict[str, Any]:
    return {
        "coordinate": account.coordinate,
        "region": list(account.region),
        "unit": account.unit,
        "share": account.share,
    }


def _gap(gap: Gap) -> dict[str, Any]:
    def pair(values: tuple[float, float] | None) -> dict[str, float] | None:
        return None if values is None else {"before": values[0], "after": values[1]}

    content = {
        "unit": gap.unit,
        "noise_floor": gap.noise_floor,
        "identify": pair(gap.identify),
        "holdout": pair(gap.holdout),
    }
    return content if gap.judged is None else content | {"judged": {"share": gap.judged[0], "after": gap.judged[1]}}


def _velocity_gap(diagnosis: Diagnosis) -> dict[str, Any]:
    """The gap, and how it was had: models held to the recording by a cascade, fed with the recorded effort."""
    content = _gap(diagnosis.velocity)
    content["loop"] = {"kind": "held", "bandwidth": {"value": diagnosis.bandwidth, "unit": "rad/s"}}
    closed = diagnosis.closed_loop
    content["closed_loop"] = None if closed is None else {"before": closed[0], "after": closed[1]}
    refined = diagnosis.refined
    content["refined"] = None if refined is None else {"before": refined[0], "after": refined[1]}
    return content


def _same_axis(compared: SameAxis) -> dict[str, Any]:
    """Whether the holdout is of the same axis; what each of the two recordings tells of what differs."""
    return {
        "same_axis": compared.same,
        "differs": [
            {
                "quantity": each.quantity,
                "unit": each.recording.unit,
                "recording": each.recording.value,
                "holdout": each.holdout.value,
                "recording_ci95": list(each.recording.ci95),
                "holdout_ci95": list(each.holdout.ci95),
            }
            for each in compared.differs
        ],
    }


def _experiment(diagnosis: Diagnosis) -> dict[str, Any] | None:
    found = diagnosis.next_experiment
    if found is None:
        return None
    speed = diagnosis.velocity.unit
    parameters = {"top_speed": (found.speed, speed), "acceleration": (found.acceleration, f"{speed}**2")}
    parameters |= {"duration": (found.duration, "s"), "repetitions": (found.repetitions, "dimensionless")}
    return {
        "profile": found.profile,
        "parameters": {key: {"value": value, "unit": unit} for key, (value, unit) in parameters.items()},
        "tells_apart": list(found.tells_apart),
        "separation": found.separation,
        "reason": found.reason,
    }


def _step(step: Shrunk) -> dict[str, Any]:
    """Gaps after an addition, of the recording and of the holdout; null where there is none."""
    content: dict[str, Any] = {"effect": step.effect}
    for name, gaps in (("torque_gap", step.torque), ("velocity_gap", step.velocity)):
        found = [gap if math.isfinite(gap) else None for gap in gaps]
        content |= {name: found[0], f"{name}_holdout": found[1] if len(found) > 1 else None}
    return content


def diagnosis_table(diagnosis: Diagnosis, title: str) -> Table:
    """Effects with their quantities, and the gaps they closed."""
    caption = [f"verdict: {diagnosis.verdict.replace('_', ' ')}", *(f"  {reason}" for reason in diagnosis.because)]
    caption += _at_fault(diagnosis)
    for name, gap in (("torque", diagnosis.torque), ("velocity", diagnosis.velocity)):
        for recording, pair in (("recording", gap.identify), ("holdout", gap.holdout)):
            if pair is not None:
                closed = f"{pair[0]:.4g} -> {pair[1]:.4g} {gap.unit}, noise floor {gap.noise_floor:.3g}"
                caption.append(f"{name} gap, {recording}: {closed}")
    caption += [
        f"the holdout differs: {each.quantity.replace('_', ' ')} {each.recording.value:.4g} -> "
        f"{each.holdout.value:.4g} {each.recording.unit}"
        for each in diagnosis.holdout.differs
    ]
    caption.append(f"velocity gap: models held to the recording at {diagnosis.bandwidth:.3g} rad/s")
    if diagnosis.closed_loop is not None:
        before, after = diagnosis.closed_loop
        caption.append(f"velocity gap under the rig's drive: {before:.4g} -> {after:.4g} {diagnosis.velocity.unit}")
    caption += [f"rejected: {found.name}, {found.reason}" for found in diagnosis.rejected]
    if diagnosis.next_experiment is not None:
        following = diagnosis.next_experiment
        caption.append(
            f"record next: {following.repetitions} times {following.profile} to {following.speed:.3g} "
            f"{diagnosis.velocity.unit}, which tells {' from '.join(following.tells_apart)} "
            f"({following.separation:.0f} times the noise): {following.reason}"
        )
    if diagnosis.unexplained_where:
        first = diagnosis.unexplained_where[0]
        low, high = first.region
        caption.append(
            f"unexplained: {diagnosis.unexplained_share:.1%} of the gap, most over {first.coordinate} "
            f"{low:.4g} to {high:.4g} {first.unit}"
        )
    table = Table(
        title=title, caption="\n".join(caption), title_justify="left", caption_justify="left", box=box.SIMPLE_HEAD
    )
    for heading in ("effect", "quantity"):
        table.add_column(heading, no_wrap=True)
    for heading in ("value", "± (95 %)"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    rows = [("", diagnosis.parameters, ()), *((e.name, e.parameters, e.ambiguous_with) for e in diagnosis.effects)]
    for name, parameters, ambiguous in rows:
        label = f"{name} (or {', '.join(ambiguous)})" if ambiguous else name
        for quantity, found in parameters.items():
            reach = f"{found.half_width:.2g}"
            table.add_row(label, words(quantity), f"{found.value:.5g}", reach, found.unit)
            label = ""
    return table


def _at_fault(diagnosis: Diagnosis) -> list[str]:
    """That a sensor errs where the axis does not."""
    sensors = [effect.name for effect in diagnosis.effects if effect.effect.kind == "measurement"]
    return [f"at fault is the sensor, not the axis: {', '.join(sensors)}"] if sensors else []


def write_diagnosis(
    out: Path, diagnosis: Diagnosis, title: str, provenance: Mapping[str, Any] | None = None, ending: str = ".png"
) -> list[Path]:
    """Write the page, `diagnosis.json`, two figures, `model.toml` and, where MuJoCo has all of it, `model.xml`.

    Args:
        out: folder, made if it is not there.
        diagnosis: what was found.
        title: rig and recordings.
        provenance: of the files it came from.
        ending: of the figures' files, one of `bench.report.figures.FORMATS`.

    Returns:
        Paths written.
    """
    toml, xml = _model_toml(diagnosis), None if diagnosis.model is None else model_xml(diagnosis.model)
    json = diagnosis_json(diagnosis, provenance) + "\n"
    files = [File(name="diagnosis.json", about="all of it as numbers", media="application/json", content=json)]
    if xml is not None:
        about = "what MuJoCo has of it natively; opens alone"
        files.insert(0, File(name="model.xml", about=about, media="application/xml", content=xml))
    about = "the model with all that was found, for bench replay"
    files.insert(0, File(name="model.toml", about=about, media="application/toml", content=toml))
    written = [out / "diagnosis.json", out / f"where{ending}", out / f"gaps{ending}", out / "model.toml"]
    with held(out):
        write_text(written[0], json)
        save(where_figure(diagnosis, title), written[1])
        save(gaps_figure(diagnosis, title), written[2])
        write_text(written[3], toml)
        if xml is not None:
            written.append(out / "model.xml")
            write_text(written[-1], xml)
        if diagnosis.next_experiment is not None:
            kind = next(kind for kind in KINDS if kind.speed_unit == diagnosis.velocity.unit)
            units = (kind.length_unit, 1.0), (kind.speed_unit, 1.0)
            written.append(out / "next_experiment.csv")
            write_text(written[-1], diagnosis.next_experiment.motion.csv(PERIOD, *units))
        return [*write_document(out, diagnosis_page(diagnosis, title, files, provenance)), *written]


def _model_toml(diagnosis: Diagnosis) -> str:
    tables = {"torque_balance": diagnosis.balance.table()}
    if diagnosis.model is not None:
        return model_toml(diagnosis.model, tables)
    return tables_toml(next(kind for kind in KINDS if kind.speed_unit == diagnosis.velocity.unit), tables)
