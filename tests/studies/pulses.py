"""Short pushes beside what no effect explains: `python -m tests.studies.pulses --logs 24 --floors 5`.

Logs of the elbow of a two-link arm by Lagrange's equations (`tests/export/two_links.py`), 12 s each. Each holds, beside
inertia and friction, a torque that nothing in the catalogue is: noise from 0.1 to 2 Hz, so many times the noise floor.
In every other a push of 50 to 100 ms and 0.5 to 0.75 N*m acts while the elbow moves one way; the twins have none.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from scipy.ndimage import minimum_filter1d
from scipy.signal import butter, sosfiltfilt

import bench
from bench.plant.robot import Robot, joint_rig, read_log
from tests.export.two_links import MJCF, Hidden, log, motion, write_log
from tests.studies.frame import publish, table

#: The elbow without cogging: what is left is the misfit alone.
PLAIN = Hidden(cogging=0.0)
#: The noise floor of such a log at its filter of 2 ms - N*m -, and how many of it the misfit has.
FLOOR, FLOORS = 1.9e-2, 5.0
#: Band of the misfit - Hz -, and what a push may be: its length - s - and its torque - N*m.
BAND, LENGTH, TORQUE = (0.1, 2.0), (0.05, 0.1), (0.5, 0.75)
#: Around a push the elbow moves one way for so long - s -, faster than a share of its speed's spread.
CLEAR, MOVES = 0.05, 0.1
#: How far off a push may be reported: its edges - s -, its impulse as a share.
NEAR, ALIKE = 5e-3, 0.1


@dataclass(frozen=True)
class ReportedPush:
    """What was said of a log: true torque and edges of its push - N*m, s -, the reported ones; nan where none is."""

    true: tuple[float, float, float]
    reported: tuple[float, float, float]
    verdict: str
    floors: float

    @property
    def found(self) -> bool:
        """Whether a push was named."""
        return bool(np.isfinite(self.reported[0]))

    @property
    def short(self) -> bool:
        """Whether one was named that is no longer than twice the longest that is put in."""
        return self.found and self.reported[2] - self.reported[1] < 2.0 * LENGTH[1]

    @property
    def size(self) -> float:
        """Reported torque over the true one, less 1."""
        return self.reported[0] / self.true[0] - 1.0

    @property
    def late(self) -> float:
        """How far off the edge is that is reported worse - s."""
        return max(abs(self.reported[k] - self.true[k]) for k in (1, 2))

    @property
    def right(self) -> bool:
        """Whether size and time are reported well enough."""
        return self.found and abs(self.size) <= ALIKE and self.late <= NEAR


def reported_push(number: int, pushed: bool, folder: Path, floors: float = FLOORS) -> ReportedPush:
    """What `diagnose` says of a log."""
    rng = np.random.default_rng([number, 61])
    phase = float(rng.uniform(0.0, 2.0 * np.pi))
    time, _, (_, speed, _) = motion(phase=phase)
    columns = log(PLAIN, seed=number, phase=phase)
    band = butter(2, BAND, "bandpass", fs=1.0 / (time[1] - time[0]), output="sos")
    other = sosfiltfilt(band, rng.standard_normal(3 * time.size))[time.size : 2 * time.size]  # away from its ends
    columns["elbow.torque [N*m]"] += floors * FLOOR * other / other.std()
    true = (np.nan, np.nan, np.nan)
    length, size = rng.uniform(*LENGTH), rng.choice([-1.0, 1.0]) * rng.uniform(*TORQUE)
    reach = round((CLEAR + length) / (time[1] - time[0]))
    around = minimum_filter1d(np.abs(speed), 2 * reach + 1)  # from a push that ends there to one that begins there
    moves = np.flatnonzero((around > MOVES * speed.std()) & (time > 1.0) & (time < 11.0))
    start = float(time[rng.choice(moves)])
    if pushed:
        true = (float(size), start, start + float(length))
        columns["elbow.torque [N*m]"] += size * ((time >= start) & (time < start + length))
    (folder / "robot.xml").write_text(MJCF)
    robot = Robot.of(folder / "robot.xml", "elbow")
    rig = joint_rig(None, robot)
    found = bench.diagnose(read_log(write_log(folder / "log.csv", columns), rig, robot, {}), rig)
    said = next((effect.values for effect in found.effects if effect.name == "load_torque_event"), None)
    reported = (np.nan, np.nan, np.nan) if said is None else (said["torque"], said["start"], said["end"])
    gap = found.torque.identify
    assert gap is not None
    return ReportedPush(true, reported, found.verdict, gap[1] / found.torque.noise_floor)


def markdown(pushed: list[ReportedPush], twins: list[ReportedPush], command: str) -> str:
    """The page."""
    found, right = (sum(getattr(one, what) for one in pushed) for what in ("found", "right"))
    sizes, late = ([getattr(one, what) for one in pushed if one.found] for what in ("size", "late"))
    rows = [
        ("logs with a push", len(pushed)),
        ("of these named", found),
        ("size within 10 % and both edges within 5 ms", right),
        ("size off, RMS", f"{100.0 * np.sqrt(np.mean(np.square(sizes))):.1f} %" if sizes else "-"),
        ("worse edge off, median", f"{1e3 * np.median(late):.1f} ms" if late else "-"),
        ("worse edge off, most", f"{1e3 * max(late):.1f} ms" if late else "-"),
        ("twins without a push", len(twins)),
        ("of these with a short one named", sum(one.short for one in twins)),
        ("of these with one named of any length", sum(one.found for one in twins)),
        ("left in the twins over noise, median", f"{np.median([one.floors for one in twins]):.1f} floors"),
    ]
    about = (__doc__ or "").partition("\n\n")[2].splitlines()
    lines = ["# Short pushes beside another misfit", "", f"`{command}`", "", *about]
    return "\n".join([*lines, "", table(("", ""), rows), ""])


def main(
    logs: int = 24,
    floors: float = FLOORS,
    out: Annotated[Path | None, typer.Option(help="Folder for pushes.md.")] = None,
) -> None:
    """Diagnose them all; print and write the table."""
    pushed, twins = list[ReportedPush](), list[ReportedPush]()
    with tempfile.TemporaryDirectory() as folder:
        for number in range(logs):
            pushed.append(reported_push(number, True, Path(folder), floors))
            twins.append(reported_push(number, False, Path(folder), floors))
            typer.echo(f"{number}: {pushed[-1]}\n    twin: {twins[-1]}")
    text = markdown(pushed, twins, f"python -m tests.studies.pulses --logs {logs} --floors {floors:g}")
    typer.echo(text)
    publish(out, {"pushes.md": text})


if __name__ == "__main__":
    typer.run(main)
