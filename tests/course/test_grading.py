"""How far an answer may be off and be right, and how likely what is said of a wrong one has to be: the limits by hand.

An answer lies about a figure as right ones do: normal in its logarithm, its tolerance being two standard deviations.
"""

import math

import pytest

from bench.course.grade import grade
from bench.course.submission import QUESTIONS, GivenAnswer, Submission

#: Promised to students: by how much of the value an answer may be off at least - percent.
TOLERANCES = {
    **dict.fromkeys(("catapult_a", "catapult_b", "catapult_c", "K_fric_w", "K_fric_0"), 2.0),
    **dict.fromkeys(("kT_stall", "kT_peak", "kT_c", "J_without_friction", "J_load_without_friction"), 0.5),
    **dict.fromkeys(("J", "J_load"), 0.5),
    **dict.fromkeys(("kT_a", "kT_b"), 1.0),
    **dict.fromkeys(("catapult_E", "corner"), 5.0),
    "alpha_max": 20.0,
    "M_max": 3.0,
}
MISTAKE, OTHER = "half-sample lag", "backward difference"
#: Tolerance of J in most tests, and the standard deviation that it stands for.
OF_J = {"J": 0.02}
DEVIATION = 0.01


def graded_answers(expected, given, truth=(), mistakes=(), tolerance=OF_J, neighbours=()):
    """What one student gets, and each of the graded answers by its quantity.

    Args:
        expected: answers of the student's own recordings.
        given: answers handed in.
        truth: true values.
        mistakes: pairs of names and the figures that they give.
        tolerance: share by which right ways are apart on the recordings.
        neighbours: what is expected of each other student.
    """
    # task 9 gives both friction terms or none
    known = {"expected": {"K_fric_0": 0.08, **expected}, "truth": dict(truth), "tolerance": tolerance}
    others = {f"{number:02}": {"expected": one} for number, one in enumerate(neighbours, 8)}
    answers = {name: GivenAnswer(value, "") for name, value in given.items()}
    graded = grade(
        Submission("07", answers, "form"), {"07": {**known, "mistakes": list(mistakes)}, **others}, "synchronised"
    )
    return graded, {answer.question.name: answer for answer in graded.answers if answer.given is not None}


def told(*arguments, **others):
    """Mistake that each wrong answer is said to be of, by its quantity."""
    _, found = graded_answers(*arguments, **others)
    return {name: answer.mistake for name, answer in found.items() if answer.verdict == "wrong"}


@pytest.mark.parametrize("name", TOLERANCES)
def test_an_answer_is_right_up_to_the_tolerance_and_no_further(name):
    """Where right ways are nearer to each other than promised the promise holds; where farther, how far they are."""
    for own, reach in ((0.0, TOLERANCES[name]), (0.9 * TOLERANCES[name], TOLERANCES[name]), (30.0, 30.0)):
        for off, verdict in ((0.99, "right"), (-0.99, "right"), (1.01, "wrong"), (-1.01, "wrong")):
            given = -4.0 * (1.0 + off * reach / 100.0)
            _, found = graded_answers({name: -4.0}, {name: given}, tolerance={name: own / 100.0})
            assert found[name].verdict == verdict, (own, off)


def test_every_quantity_is_promised_but_the_error_that_each_right_way_has_its_own_of():
    assert {question.name for question in QUESTIONS} - set(TOLERANCES) == {"E"}
    graded, found = graded_answers({"E": 1.0}, {"E": 7.0})
    assert found["E"].verdict == "not judged"
    assert math.isnan(graded_answers({}, {"J": 1.0})[1]["J"].expected)
    assert (graded.right, graded.judged) == (0, len(TOLERANCES))


def test_where_zero_is_right_a_tenth_stands_for_it():
    """kT_b is 0 by the course's own condition: 1 % of 0.1 N*m/A**2 is allowed."""
    for value, verdict in ((0.99e-3, "right"), (-0.99e-3, "right"), (1.01e-3, "wrong")):
        assert graded_answers({"kT_b": 0.0}, {"kT_b": value})[1]["kT_b"].verdict == verdict
    assert told({"kT_b": 0.0}, {"kT_b": 0.5}) == {"kT_b": ""}


def test_an_answer_is_right_by_the_truth_or_by_the_courses_way():
    for value, verdict in ((22.0, "right"), (23.0, "right"), (22.5, "wrong")):
        assert graded_answers({"J": 22.0}, {"J": value}, truth={"J": 23.0})[1]["J"].verdict == verdict


def test_a_mistake_is_named_as_long_as_it_is_likelier_than_one_that_is_not_known():
    """J half too large is a mistake's (1 in 100) within 4.19 deviations of its figure, else not known (1 in 1000).

    Anything there has a density of 0.25/1.5 * 1.5**(-1/1.5) = 0.127, half of which goes to what is not known:
    1e-2 * 0.999 * exp(-z**2/2) / (0.01 * sqrt(2*pi)) + 1e-2 * 1e-3 * 0.127 = 1e-3 * 0.5 * 0.127 at z = 4.19.
    """
    for apart, mistake in ((4.15, MISTAKE), (-4.15, MISTAKE), (4.23, ""), (-4.23, "")):
        figure = 30.0 * math.exp(apart * DEVIATION)
        assert told({"J": 20.0}, {"J": 30.0}, mistakes=[([MISTAKE], {"J": figure})]) == {"J": mistake}, apart


def test_two_mistakes_are_told_both_where_none_is_twenty_times_likelier():
    """One is on the answer, the other z deviations off: exp(z**2/2) is 20 at z = 2.448."""
    for apart, alone in ((2.43, False), (-2.43, False), (2.47, True), (-2.47, True)):
        ways = [([OTHER], {"J": 30.0 * math.exp(apart * DEVIATION)}), ([MISTAKE], {"J": 30.0})]
        mistake = MISTAKE if alone else f"{MISTAKE}, or {OTHER}"
        assert told({"J": 20.0}, {"J": 30.0}, mistakes=ways) == {"J": mistake}, apart


def test_how_much_likelier_is_said_beside_it():
    """z deviations off the next is exp(z**2/2); at 5 the next is the mistake with a slip that changes nothing here."""
    slipped = f"{MISTAKE} and J_motor not subtracted"  # 1 in 10000, and the mistake 1 in 100
    told_apart = ((2.0, f"7.4 times likelier than {OTHER}"), (2.12, f"9.5 times likelier than {OTHER}"))
    for apart, words in (*told_apart, (5.0, f"100 times likelier than {slipped}")):
        ways = [([MISTAKE], {"J": 30.0}), ([OTHER], {"J": 30.0 * math.exp(apart * DEVIATION)})]
        _, found = graded_answers({"J": 20.0}, {"J": 30.0}, mistakes=ways)
        assert found["J"].explained.likelier == words


def test_no_student_reads_of_another():
    """An answer that is a neighbour's is not known to be of a mistake, and nothing is said of the neighbour."""
    graded, found = graded_answers({"J": 20.0}, {"J": 30.0}, neighbours=[{"J": 30.0}])
    assert (found["J"].verdict, found["J"].mistake) == ("wrong", "")
    assert not any("08" in answer.remark or "copi" in answer.remark for answer in graded.answers)


FORGOTTEN = "J_motor not subtracted"
PAIR = ([MISTAKE, OTHER], {"J": 30.0})
J, J_W = {"J": 20.0}, {"J": 20.0, "K_fric_w": 1e-3}
LOADS, WRONG_LOADS = {"J": 20.0, "J_load": 19.0}, {"J": 30.0, "J_load": 29.0}
#: What is expected, given and known of mistakes, and the mistake that each wrong answer is said to be of.
TOLD = {
    "one mistake before two": (J, {"J": 30.0}, [PAIR, ([OTHER], {"J": 30.0})], {"J": OTHER}),
    "two that alone give it": (J, {"J": 30.0}, [PAIR, ([OTHER], {"J": 40.0})], {"J": f"{MISTAKE} and {OTHER}"}),
    "a slip on right figures": (LOADS, {"J": 20.0, "J_load": 20.0}, [([MISTAKE], WRONG_LOADS)], {"J_load": FORGOTTEN}),
    "a mistake without a slip": (LOADS, WRONG_LOADS, [([MISTAKE], WRONG_LOADS)], dict.fromkeys(LOADS, MISTAKE)),
    "a mistake and a slip": (
        LOADS,
        {"J": 30.0, "J_load": 30.0},
        [([MISTAKE], WRONG_LOADS)],
        dict.fromkeys(LOADS, f"{MISTAKE} and {FORGOTTEN}"),
    ),
    "the one that explains more": (
        J_W,
        {"J": 30.0, "K_fric_w": 2e-3},
        [([MISTAKE], {"J": 30.0}), ([OTHER], {"J": 30.3, "K_fric_w": 2e-3})],
        dict.fromkeys(J_W, OTHER),
    ),
    "the one that keeps what is right": (
        J_W,
        {"J": 30.0, "K_fric_w": 1e-3},
        [([MISTAKE], {"J": 30.0, "K_fric_w": 5e-3}), ([OTHER], {"J": 30.3, "K_fric_w": 1e-3})],
        {"J": OTHER},
    ),
    "none for what it does not give": (
        {**J_W, "K_fric_0": 0.08},
        {"J": 30.0, "K_fric_w": 2e-3, "K_fric_0": 1.7},
        [([MISTAKE], {"J": 30.0, "K_fric_w": 2e-3})],
        {"J": MISTAKE, "K_fric_w": MISTAKE, "K_fric_0": ""},
    ),
    "none of another task": (
        {"J": 20.0, "M_max": 3.5},
        {"J": 30.0, "M_max": 5.0},
        [([MISTAKE], {"J": 30.0, "M_max": 9.0})],
        {"J": MISTAKE, "M_max": ""},
    ),
    "none that gives zero": (J, {"J": 30.0}, [([MISTAKE], {"J": 0.0})], {"J": ""}),
    "none for zero": (J, {"J": 0.0}, [([MISTAKE], {"J": 30.0})], {"J": ""}),
}


@pytest.mark.parametrize("case", TOLD)
def test_the_likeliest_mistake_is_told(case):
    """Two at once are 1 in 10000, one is 1 in 100; nothing is a share of zero away from it."""
    expected, given, ways, found = TOLD[case]
    assert told(expected, given, mistakes=ways) == found


def test_the_remaining_error_tells_two_mistakes_apart_that_give_the_same_answers():
    """E has no tolerance of its own: 4 % of a figure are two deviations."""
    ways = [([MISTAKE], {"J": 30.0, "E": 2.0}), ([OTHER], {"J": 30.0, "E": 2.3})]
    expected = {"J": 20.0, "E": 1.0}
    assert told(expected, {"J": 30.0, "E": 2.01}, mistakes=ways) == {"J": MISTAKE}
    assert told(expected, {"J": 30.0, "E": 2.29}, mistakes=ways) == {"J": OTHER}
    # of one, J is two deviations off, of the other E is by less, or by more: exp(2) against exp(z**2/2)
    for apart, first in ((1.9, OTHER), (2.1, MISTAKE)):
        near = ([MISTAKE], {"J": 30.0 * math.exp(2.0 * DEVIATION), "E": 2.0})
        far = ([OTHER], {"J": 30.0, "E": 2.0 * math.exp(apart * 0.02)})
        assert told(expected, {"J": 30.0, "E": 2.0}, mistakes=[near, far])["J"].startswith(f"{first}, or ")


def test_what_a_task_leaves_open_another_task_tells():
    """Of two mistakes M_max alone tells neither: one is on it, the other z deviations of 1.5 % off, exp(z**2/2) to 1.

    J is of one alone, so that is 50 times likelier made in task 10 too: 50*exp(-z**2/2) is 20 at z = 1.354.
    """
    expected, given = {"J": 20.0, "M_max": 3.5}, {"J": 30.0, "M_max": 4.2}
    open_ = ([OTHER], {"M_max": 4.2})
    for apart in (0.1, -1.34, 1.37):
        of_j = ([MISTAKE], {"J": 30.0, "M_max": 4.2 * math.exp(0.015 * apart)})
        alone = told({"M_max": 3.5}, {"M_max": 4.2}, mistakes=[open_, of_j])
        assert alone == {"M_max": f"{OTHER}, or {MISTAKE}"}
        both = MISTAKE if abs(apart) < 1.35 else f"{MISTAKE}, or {OTHER}"
        assert told(expected, given, mistakes=[open_, of_j]) == {"J": MISTAKE, "M_max": both}, apart
    # what another task tells is not held against what this one tells by itself
    far = ([MISTAKE], {"J": 30.0, "M_max": 5.0})
    assert told(expected, given, mistakes=[open_, far]) == {"J": MISTAKE, "M_max": OTHER}
    assert told(expected, given, mistakes=[([MISTAKE], {"J": 30.0}), open_]) == {"J": MISTAKE, "M_max": OTHER}
