"""Recordings with mistakes drawn at random, of random strengths, on random axes, through every task of the course.

    python -m tests.studies.mistaken --count 300 --seed 25 --out docs/mistaken.md
    python -m tests.studies.mistaken --count 20 --seed 3 --pairs 20

Each is a recorded axis of a class, the mistake is put into what its student would hand in, and the report is asked
which numbers are done. A wrong number is one that is done, further from the truth than its 95 %, and not so without the
mistake. Tasks that only simulate, and diagrams, are left out.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections import defaultdict
from pathlib import Path

import numpy as np

from bench.course.catapult import fly
from bench.course.record import record_class
from tests.course.mistakes import MISTAKES, Folder, recorded_in, tasks_of, wrong_numbers
from tests.studies.frame import table

#: Axes that mistakes are spread over.
AXES = 10


def axes(folder, seed):
    """Folders of a class' students with the truth of each, by task and name in the report's units."""
    record_class(folder / "class", AXES, seed, salt=seed)
    known = json.loads((folder / "class.truth.json").read_text(encoding="utf-8"))["students"]
    throw = dict(zip("abc", fly().coefficients.tolist(), strict=True))
    found = []
    for name, student in known.items():
        true = student["truth"]
        values = {("1", coefficient): value for coefficient, value in throw.items()}
        values |= {(task, key): true[key] for task in "69" for key in ("J", "J_load")}
        values |= {("9", key): true[key] for key in ("K_fric_w", "K_fric_0")} | {
            ("10", "measured corner"): true["corner"]
        }
        found.append((folder / "class" / f"student-{name}", values))
    return found


def with_mistakes(folder, mistakes, random, place):
    """Tasks of the report on a student's recordings with mistakes in them."""
    tables, flights = recorded_in(folder)
    of = Folder(dict(tables), list(flights))
    for mistake in mistakes:
        mistake(of, random)
    of.write(place / "data")
    (place / "data" / "rig.toml").write_bytes((folder / "rig.toml").read_bytes())
    return tasks_of(place / "data")


def measured(count, pairs, seed, say=print):
    """Rows of the study: names of the mistakes, wrong numbers, and whether each cause is named."""
    rows = []
    with tempfile.TemporaryDirectory() as place:
        students = axes(Path(place), seed)
        sound = [
            set(wrong_numbers(with_mistakes(one, (), None, Path(place) / f"sound {k}"), true))
            for k, (one, true) in enumerate(students)
        ]
        outside, numbers = sum(map(len, sound)), sum(len(true) for _, true in students)
        say(f"{outside} of {numbers} numbers of sound recordings outside their 95 %")
        for number in range(count + pairs):
            random = np.random.default_rng([seed, number])
            mistakes = random.choice([*MISTAKES], 1 if number < count else 2, replace=False)
            which = int(random.integers(len(students)))
            tasks = with_mistakes(students[which][0], mistakes, random, Path(place) / str(number))
            wrong = set(wrong_numbers(tasks, students[which][1])) - sound[which]
            reasons = " ".join(task["reason"] for task in tasks if task["status"] == "not_done")
            named = [MISTAKES[mistake] in reasons for mistake in mistakes]
            rows.append(([mistake.__name__ for mistake in mistakes], sorted(wrong), named))
            if wrong or not all(named):
                say(number, *rows[-1], reasons[:600])
    return rows


def by_mistake(rows):
    """Markdown: of each mistake alone how many, how many with a wrong number, how many named; of pairs in all."""
    found = defaultdict(list)
    for names, wrong, named in rows:
        found[names[0] if len(names) == 1 else "two at random"].append((bool(wrong), all(named), any(named)))
    lines = []
    for name, results in sorted(found.items(), key=lambda item: (item[0] == "two at random", item[0])):
        wrong, every, one = (sum(column) for column in zip(*results, strict=True))
        last = one if name == "two at random" else ""
        lines.append((name.replace("_", " "), len(results), wrong, every, last))
    single = [(bool(wrong), all(named)) for names, wrong, named in rows if len(names) == 1]
    lines.append(("**all single**", len(single), sum(w for w, _ in single), sum(t for _, t in single), ""))
    return table(("mistake", "recordings", "wrong number done", "named", "one of them named"), lines) + "\n"


def main():
    """Run it, print what goes wrong, and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=300, help="recordings with one mistake")
    parser.add_argument("--pairs", type=int, default=0, help="and with two")
    parser.add_argument("--seed", type=int, default=25, help="of axes, mistakes and strengths")
    parser.add_argument("--out", type=Path, help="file for the table")
    given = parser.parse_args()
    text = by_mistake(measured(given.count, given.pairs, given.seed))
    print(text)
    if given.out:
        command = f"python -m tests.studies.mistaken --count {given.count} --pairs {given.pairs} --seed {given.seed}"
        head = f"# Mistaken recordings of the lab course\n\n`{command}`, on {AXES} axes ([the course](lab.md)):\n\n"
        given.out.write_text(head + text, encoding="utf-8")


if __name__ == "__main__":
    main()
