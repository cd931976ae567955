"""How often two forms are suspected that are honest, and how often copied ones are found: 1000 classes of 20.

    python -m tests.studies.copied --classes 1000 --students 20 --seed 1

In every class all students but one work honestly on recordings of an own axis: some right, some with a mistake of the
catalogue, most with one that it does not have: a factor of their own or one that is going round, another threshold,
other conditions of kT(Iq), a sign. The last one copies another's form with a jitter of 0.15 to 1 %.

Axes are drawn as `bench lab --record --students` draws them. How far a known mistake moves an answer, and what errors
remain, is taken from recorded students, of whom each drawn one is one.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np

from bench.course import record
from bench.course.grade import read_truth_of_class
from bench.course.submission import QUESTIONS
from bench.course.suspicion import COMPARED, OF_ERROR, SUSPECT, evidence

#: Factors that are going round among students.
GOING_ROUND = (2.0, 0.5, np.sqrt(3.0), 1.0 / np.sqrt(3.0), np.pi, 0.1, 10.0, 1.5, 9.81)
#: Powers of a factor on the torque, and of one on the speed, in the answers of COMPARED.
TORQUE, SPEED = np.array([0.0, 1.0, 1.0, 1.0, 2.0]), np.array([0.0, -1.0, -1.0, 0.0, 0.0])
J, K_W, K_0, E = 1, 2, 3, 4


def donors(truth: Path) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Of each student of a class: expected (q,), standard deviations (q,), and ratios of known mistakes (k, q)."""
    promised = {question.name: question.tolerance for question in QUESTIONS}
    known, found = read_truth_of_class(truth), []
    for one in known.values():
        expected = np.array([one["expected"][name] for name in COMPARED])
        own = [max(promised[name] or 0.0, one["tolerance"].get(name, 0.0)) for name in COMPARED]
        spread = np.array(
            [0.5 * width if promised[name] else OF_ERROR for name, width in zip(COMPARED, own, strict=True)]
        )
        figures = np.array([[of.get(name, np.nan) for name in COMPARED] for _, of in one["mistakes"]])
        figures[:, 0] = expected[0]
        found.append((expected, spread, figures / expected))
    return found


def drawn_class(random, students, bank):
    """Expected answers, deviations and known mistakes' answers of a class: (n, q), (n, q), (n, k, q)."""
    chosen = random.integers(len(bank), size=students)
    base, spread, ratio = (np.stack([bank[k][part] for k in chosen]) for part in range(3))
    theory = random.uniform(*record.DIAMETER, students) ** 4 * random.uniform(*record.THICKNESS, students)
    inertia = 22.25 * theory / (0.1375**4 * 6.5e-3) * random.uniform(1.1, 1.2, students) / 1.15
    noise = random.uniform(*record.VELOCITY_NOISE, students) ** 2 * inertia**2
    noise += 60.0 * random.uniform(*record.CURRENT_NOISE, students) ** 2
    expected = np.stack(
        [
            base[:, 0],
            inertia,
            random.uniform(*record.VISCOUS, students),
            random.uniform(*record.COULOMB, students),
            base[:, 4] * noise / noise.mean(),
        ],
        axis=1,
    )
    expected[:, 0] *= np.exp(0.2 * random.standard_normal(students))
    return expected, spread, expected[:, None] * ratio


def honest(random, expected, spread, known):
    """Answers (n, q) of students who work by themselves."""
    given = expected * np.exp(spread * random.standard_normal(expected.shape) * 0.5)
    round_here = random.choice(GOING_ROUND, size=2)
    for k, kind in enumerate(random.choice(9, size=len(given), p=(0.2, 0.15, 0.15, 0.1, 0.1, 0.1, 0.08, 0.07, 0.05))):
        own = random.uniform(0.85, 1.15)
        factor = random.choice(round_here) if random.random() < 0.4 else own
        if kind == 1:  # a known mistake
            figures = known[k, random.integers(known.shape[1])]
            given[k] = np.where(np.isfinite(figures), figures, given[k])
        elif kind == 2:  # a factor of its own on the torque
            given[k] *= factor**TORQUE
        elif kind == 3:  # on the speed
            given[k] *= factor**SPEED
        elif kind == 4:  # another threshold or filter: friction and error move, inertia little
            shift = random.normal(0.0, 0.3)
            given[k, [K_W, K_0]] *= 1.0 - 1.2 * shift, 1.0 + shift
            given[k, J] *= 1.0 + 0.05 * shift
            given[k, E] *= 1.0 + 20.0 * shift**2
        elif kind == 5:  # other conditions of kT: torque by a factor that goes with the current
            given[k] *= own ** (TORQUE * random.uniform(0.7, 1.3, TORQUE.size))
        elif kind == 6:  # a sign of its own
            given[k, random.choice([J, K_W, K_0])] *= -1.0
        elif kind == 7:  # each answer off by itself
            given[k] *= np.exp(random.normal(0.0, 0.3, TORQUE.size))
        elif kind == 8:  # the error as its mean, or its root
            given[k, [0, E]] = given[k, [0, E]] / 200.0 if own > 1.0 else np.sqrt(np.abs(given[k, [0, E]]))
    return given


def measured(classes, students, seed, bank):
    """Evidence of every copy (classes,), of all honest pairs, and the share of copies whose source comes first."""
    random, copies, pairs, first = np.random.default_rng(seed), [], [], 0
    for _ in range(classes):
        expected, spread, known = drawn_class(random, students, bank)
        given = honest(random, expected, spread, known)
        copied = random.integers(students - 1)
        jitter = random.uniform(0.0015, 0.01)
        given[-1] = given[copied] * (1.0 + jitter * random.standard_normal(given.shape[1]))
        found = evidence(given, expected, spread, known, given, expected)
        first += int(np.argmax(found[-1]) == copied)
        both = np.maximum(found, found.T)
        copies.append(both[-1, copied])
        both[copied, -1] = np.nan
        rest = both[np.triu_indices(students, 1)]
        pairs.append(rest[np.isfinite(rest)])
    return np.array(copies), np.concatenate(pairs), first / classes


def main() -> None:
    """Print both rates."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    for name, preset in (("--classes", 1000), ("--students", 20), ("--seed", 1), ("--recorded", 6)):
        parser.add_argument(name, type=int, default=preset)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        *_, truth = record.record_class(Path(folder) / "class", asked.recorded, asked.seed)
        bank = donors(truth)
    copies, pairs, first = measured(asked.classes, asked.students, asked.seed, bank)
    suspected, found = (int(np.count_nonzero(of > SUSPECT)) for of in (pairs, copies))
    print(f"{suspected} of {pairs.size} honest pairs suspected, {1000.0 * suspected / pairs.size:.3f} in 1000")
    print(f"{found} of {copies.size} copies found, {found / copies.size:.1%}; their source first in {first:.1%}")
    print("log10 of evidence, share of copies above, honest pairs above:")
    for level in np.arange(2.0, 6.1, 0.5):
        print(f"  {level:.1f}: {np.mean(copies > level):.3f}, {np.count_nonzero(pairs > level)}")


if __name__ == "__main__":
    main()
