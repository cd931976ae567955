"""Results as Markdown, and one line a case as CSV."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import median

from bench.validation.independent.effects import CATALOGUE
from tests.studies.blind.draw import STRENGTHS
from tests.studies.blind.parameters import ANGLES, WHOLE, Compared
from tests.studies.blind.score import Score, same, twins
from tests.studies.frame import csv_of, table

#: Truth's residual over what sensor noise makes of it, below which no noise floor could show the effect.
VISIBLE = 1.12
HEADINGS = (
    *("case", "hidden", "strength", "severity", "residual_ratio", "sample_period_ms", "noise", "linear"),
    *("named", "verdict", "right", "chi_before", "chi_after", "inertia_error", "gap_closed"),
    *("inside", "outside_interval", "seconds", "refused"),
)


def ratio(scores: Sequence[Score], holds: Callable[[Score], bool] = lambda score: score.right) -> str:
    """`right/all`."""
    return f"{sum(map(holds, scores))}/{len(scores)}" if scores else "-"


def middle(values: Sequence[float | None], digits: str) -> str:
    """Median of what is there."""
    known = [value for value in values if value is not None and value == value]
    return format(median(known), digits) if known else "-"


def markdown(scores: Sequence[Score], title: str, command: str) -> str:
    """All figures of a run."""
    parts = [f"# {title}", f"`{command}`", headline(scores), by_strength(scores), coverage(scores), wrong(scores)]
    return "\n\n".join(part for part in parts if part) + "\n"


def headline(scores: Sequence[Score]) -> str:
    """What the whole set comes to."""
    lines = abstention(scores) if any(score.without_truth for score in scores) else naming(scores)
    lines += sureness(scores, any(score.without_truth for score in scores))
    lines += [
        ("refused", ratio(scores, lambda s: bool(s.outcome.refused))),
        ("seconds a case, median and most", seconds(scores)),
    ]
    return table(("what", ""), lines)


def abstention(scores: Sequence[Score]) -> list[tuple[str, str]]:
    """How often nothing is named when what is hidden is not in the catalogue."""
    return [
        ("left unnamed with a remainder", ratio([score for score in scores if score.hidden])),
        ("a wrong name", ratio(scores, misnamed)),
        ("a wrong name, and no remainder", ratio(scores, lambda s: misnamed(s) and not remains(s))),
        ("no missing effect found", ratio(scores, lambda s: s.outcome.verdict == "nothing_missing")),
    ]


def naming(scores: Sequence[Score]) -> list[tuple[str, str]]:
    """Right by group, and medians over cases with something of the catalogue hidden."""
    groups = {g: [s for s in scores if s.group == g] for g in ("single", "pair", "null", "outside", "crowd", "triple")}
    crowds = [*groups["crowd"], *groups["triple"]]
    hidden = sum(len(s.truth["effects"]) for s in crowds)
    found = hidden - sum(len(same(s.truth["effects"]) - same(list(s.outcome.named))) for s in crowds)
    known = [*groups["single"], *groups["pair"]]
    judged = [s for s in known if s.intervals]
    quantities = [ok for s in known for ok in s.intervals]
    return [
        ("single effects named exactly", ratio(groups["single"])),
        ("pairs named exactly", ratio(groups["pair"])),
        ("effects of crowds named", f"{found}/{hidden}" if crowds else "-"),
        ("crowds with a wrong name", ratio(crowds, misnamed)),
        ("nulls with a name", ratio(groups["null"], lambda s: bool(s.outcome.named))),
        ("nulls with a remainder", ratio(groups["null"], lambda s: s.outcome.verdict == "unexplained_remainder")),
        ("not in the catalogue, unnamed with a remainder", ratio(groups["outside"])),
        ("cases with something hidden and a wrong name", ratio([*known, *groups["outside"]], misnamed)),
        ("singles and pairs with a remainder next to right names", ratio([s for s in known if s.right], remains)),
        ("holdout torque gap closed, median", middle([s.closed for s in known], ".3f")),
        ("inertia error, median", middle([100.0 * abs(s.inertia_error) for s in known], ".4f") + " %"),
        ("quantities within their 95 % interval", f"{sum(quantities)}/{len(quantities)}"),
        ("cases with every quantity within", ratio(judged, lambda s: all(s.intervals))),
    ]


def sureness(scores: Sequence[Score], withheld: bool) -> list[tuple[str, str]]:
    """How likely the truth was held to be, and whether that is as often so."""
    known = [score for score in scores if score.outcome.likely or not score.outcome.refused]
    lacking = [s for s in known if s.group == "outside" or (withheld and s.hidden)]
    hidden = [s for s in known if s.truth["effects"] and s not in lacking]
    true = [
        share for s in hidden for name, share in s.outcome.likely.items() if twins(name) in same(s.truth["effects"])
    ]
    missed = sum(len(same(s.truth["effects"]) - same(list(s.outcome.likely))) for s in hidden)
    pairs = [
        (share, s not in lacking and twins(name) in same(s.truth["effects"]))
        for s in known
        for name, share in s.outcome.likely.items()
    ]
    return [
        ("mean probability of a true name", mean([*true, *[0.0] * missed])),
        ("expected calibration error of names", f"{calibration_error(pairs):.3f} of {len(pairs)}"),
        ("sets of 90 % that hold the truth", ratio(known, lambda s: holds(s, s in lacking))),
        ("unknown effect above .5 where it is so", ratio(lacking, lambda s: s.outcome.none > 0.5)),
        ("a name above .5 in a null", ratio([s for s in known if s.group == "null"], lambda s: likeliest(s) > 0.5)),
    ]


def mean(values: Sequence[float]) -> str:
    """Mean."""
    return f"{sum(values) / len(values):.3f} of {len(values)}" if values else "-"


def likeliest(score: Score) -> float:
    """Probability of the likeliest name."""
    return max(score.outcome.likely.values(), default=0.0)


def holds(score: Score, lacking: bool) -> bool:
    """Whether the sets of a case hold its truth."""
    if lacking:
        return None in score.outcome.sets
    truth = same(score.truth["effects"])
    return any(names is not None and same(list(names)) == truth for names in score.outcome.sets)


def calibration_error(pairs: Sequence[tuple[float, bool]], bins: int = 10) -> float:
    """Expected calibration error: how far probabilities in bins are from how often they are right, by their number."""
    error = 0.0
    for k in range(bins):
        own = [(share, right) for share, right in pairs if min(int(bins * share), bins - 1) == k]
        error += abs(sum(share - right for share, right in own))
    return error / max(len(pairs), 1)


def seconds(scores: Sequence[Score]) -> str:
    """Median and largest time."""
    times = [score.outcome.seconds for score in scores]
    return f"{median(times):.1f}, {max(times):.1f}" if times else "-"


def misnamed(score: Score) -> bool:
    """Whether a name was given that is not hidden."""
    return bool(false_names(score))


def false_names(score: Score) -> list[str]:
    """Names given that are neither hidden nor the twin of one."""
    return [name for name in score.outcome.named if twins(name) not in same(score.truth["effects"])]


def remains(score: Score) -> bool:
    """Whether a remainder is reported."""
    return score.outcome.verdict == "unexplained_remainder"


def by_strength(scores: Sequence[Score]) -> str:
    """Right and all of each single effect by strength, and those whose truth stands out of the noise at all."""
    singles = [score for score in scores if score.group == "single"]
    if not singles:
        return ""
    rows = []
    for effect in CATALOGUE:
        those = [score for score in singles if score.hidden == effect]
        cells = [ratio([s for s in those if s.truth["strength"] == strength]) for strength in STRENGTHS]
        visible = [s for s in those if s.truth["residual_ratio"] > VISIBLE]
        error = middle([100.0 * abs(s.inertia_error) for s in those], ".3f")
        cells += [ratio(visible), error, middle([s.closed for s in those], ".2f")]
        rows.append((effect, *cells))
    totals = [ratio([s for s in singles if s.truth["strength"] == strength]) for strength in STRENGTHS]
    totals.append(ratio([s for s in singles if s.truth["residual_ratio"] > VISIBLE]))
    rows.append(("**all**", *totals, "", ""))
    note = (
        f"Above noise: those whose truth has a residual above {VISIBLE} times that of the sensors' noise "
        "in the torque balance of J, K_w, K_0. All cases count in the figures above."
    )
    heads = ("hidden", *STRENGTHS, "above noise", "J error %", "gap closed")
    return "## By effect and strength\n\n" + table(heads, rows) + "\n\n" + note


def coverage(scores: Sequence[Score]) -> str:
    """How often the interval of each quantity holds the truth, and how far reported values are from it."""
    found: dict[tuple[str, str], list[Compared]] = {}
    for score in scores:
        for effect, those in score.quantities.items():
            for key, one in those.items():
                found.setdefault((effect, key), []).append(one)
    if not found:
        return ""
    rows = []
    order = list(CATALOGUE)
    for (effect, key), those in sorted(found.items(), key=lambda item: order.index(item[0][0])):
        error = middle([one.error * (1.0 if key in ANGLES else 100.0) for one in those], ".2g")
        unit = "" if error == "-" else " rad" if key in ANGLES else " %"
        furthest = "" if key in WHOLE else f"{max(one.half_widths for one in those):.1f}"
        within = f"{sum(one.inside for one in those)}/{len(those)}"
        rows.append((effect, key, within, f"{error}{unit}", furthest))
    heads = ("hidden", "quantity", "truth within interval", "error, median", "furthest, half widths")
    return "## Quantities\n\n" + table(heads, rows)


def wrong(scores: Sequence[Score]) -> str:
    """Cases that are not right."""
    bad = [score for score in scores if not score.right]
    if not bad:
        return ""
    rows = []
    for score in bad:
        said = score.outcome.refused or score.outcome.verdict
        before, after = score.outcome.chi
        cells = (
            score.name,
            score.hidden,
            f"{score.truth['severity']:.2f}",
            f"{score.truth['residual_ratio']:.2f}",
            ", ".join(score.outcome.named),
            said,
            f"{before:.2f} -> {after:.2f}",
        )
        rows.append(cells)
    heads = ("case", "hidden", "severity", "above noise", "named", "verdict", "chi")
    return "## Not right\n\n" + table(heads, rows)


def cases_csv(scores: Sequence[Score]) -> str:
    """One line a case."""
    rows = []
    for score in scores:
        truth, outcome = score.truth, score.outcome
        quantities = [(f"{e}.{key}", one) for e, those in score.quantities.items() for key, one in those.items()]
        rows.append(
            (
                score.name,
                score.hidden,
                truth["strength"],
                truth["severity"],
                truth["residual_ratio"],
                f"{truth['sample_period'] * 1e3:g}",
                truth["noise"],
                int(truth["linear"]),
                "+".join(outcome.named),
                outcome.verdict,
                int(score.right),
                *(f"{chi:.3f}" for chi in outcome.chi),
                f"{score.inertia_error:.2e}",
                "" if score.closed is None else f"{score.closed:.4f}",
                sum(one.inside for _, one in quantities),
                " ".join(f"{name}:{one.half_widths:.1f}" for name, one in quantities if not one.inside),
                f"{outcome.seconds:.1f}",
                outcome.refused,
            )
        )
    return csv_of(HEADINGS, rows)
