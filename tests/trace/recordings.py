"""Recordings for tests: a motion in closed form, and Machine Expert traces built to their published structure."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

SHARED = Path(__file__).parents[3] / "shared" / "data"


def shared(*parts: str) -> Path:
    """Path of a public recording; the test is skipped where the recordings are absent."""
    path = SHARED.joinpath(*parts)
    if not path.exists():
        pytest.skip(f"public recordings are not here ({path})")
    return path


def velocity(time):
    """A smooth run in deg/s with frequencies up to 12 Hz."""
    return 900.0 * np.sin(2 * np.pi * 1.3 * time) + 120.0 * np.cos(2 * np.pi * 12.0 * time)


def current(time):
    """Its current in mA."""
    return 1500.0 * np.cos(2 * np.pi * 1.3 * time) - 200.0 * np.sin(2 * np.pi * 12.0 * time)


def csv_text(time, **columns):
    """Canonical CSV; a column's unit stands after two underscores, e.g. `velocity__deg_s`."""
    units = {"s": "s", "ms": "ms", "deg": "deg", "deg_s": "deg/s", "mA": "mA", "A": "A", "rad_s": "rad/s", "rad": "rad"}
    head = ["time [s]"]
    for key in columns:
        name, _, unit = key.partition("__")
        head.append(f"{name} [{units[unit]}]")
    rows = zip(time, *columns.values(), strict=True)
    return "\n".join([",".join(head), *(",".join(repr(float(x)) for x in row) for row in rows)]) + "\n"


def machine_expert_xml(variables, microseconds=False, settings=()):
    """Text of a trace file; `variables` maps a PLC name to (time stamps, values)."""
    singles = "".join(f'<Single Name="{name}" Type="string">{text}</Single>' for name, text in settings)
    records = "".join(
        f'<TraceVariable VarName="{name}" VariableIndex="{index}" Type="System.Double">'
        f"<Values>{','.join(repr(float(v)) for v in values)}</Values>"
        f"<Timestamps>{','.join(str(int(t)) for t in stamps)}</Timestamps></TraceVariable>"
        for index, (name, (stamps, values)) in enumerate(variables.items())
    )
    return (
        '<?xml version="1.0" encoding="utf-16"?>'
        f'<Trace><TraceConfiguration>{singles}<Single Name="MicroSeconds" Type="bool">{microseconds}</Single>'
        '</TraceConfiguration><TraceData Version="1.0.0.0">'
        f"<TraceRecord>{records}</TraceRecord></TraceData></Trace>"
    )


def write_utf16(path, text):
    """UTF-16 LE with its byte order mark, as the trace editor saves."""
    path.write_bytes(b"\xff\xfe" + text.encode("utf-16-le"))
    return path
