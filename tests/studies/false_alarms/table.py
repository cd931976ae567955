"""Tables of answers."""

from __future__ import annotations

from collections.abc import Mapping

from tests.studies.false_alarms.run import SHOWN, Answers
from tests.studies.frame import table

NOTE = f"""Recordings of the independent integrator, 4 s each, sensors drawn at random. Bounds are Clopper and Pearson's
at 95 %. `refused`: no answer, as the recording determines too little. `allows it`: errors, spread and margin of the
unchanged axis leave a chance of 95 % to find the change; of a new effect, that the residual torque of J, K_w and K_0
is {SHOWN} times the noise. `found`: what was changed is called changed, by its name."""
HEADS = ("what", "checks", "refused", "same", "undecided", "changed", "changed, share", "allows it", "found", "share")


def markdown(parts: Mapping[str, Answers], command: str) -> str:
    """All answers as a page."""
    rows = table(HEADS, (_row(name, answers) for name, answers in parts.items()))
    alarms = [f"- {name}: {_alarms(found)}" for name, found in parts.items() if _no_change(name) and found.alarms]
    section = ["", "What unchanged axes were called changed in:", "", *alarms] if alarms else []
    return "\n".join(["# What `bench check` answers", "", f"`{command}`", "", NOTE, "", rows, *section, ""])


def _no_change(name: str) -> bool:
    return name.startswith(("unchanged", "another", "half"))


def _alarms(answers: Answers) -> str:
    return ", ".join(f"{name} {count}" for name, count in answers.alarms.most_common())


def _row(name: str, answers: Answers) -> list[object]:
    results, (low, high) = answers.results, answers.bounds("changed")
    found, allowed, least, most = answers.detected()
    share = results["changed"] / max(answers.answered, 1)
    detected = f"{found / allowed:.1%} ({least:.1%} to {most:.1%})" if allowed else "-"
    counts = [results[key] for key in ("refused", "same", "undecided", "changed")]
    cells = [name, sum(results.values()), *counts, f"{share:.1%} ({low:.1%} to {high:.1%})"]
    return [*cells, allowed or "-", found if allowed else "-", detected]
