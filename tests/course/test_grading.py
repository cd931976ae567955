"""How far an answer may be off and be right, and how near a mistake's figure it is named: the limits themselves."""

import math

import pytest

from bench.course.grade import grade
from bench.course.submission import QUESTIONS, GivenAnswer, Submission

#: Promised to students: by how much of the value an answer may be off - percent.
TOLERANCES = {
    "catapult_a": 2.0,
    "catapult_b": 2.0,
    "catapult_c": 2.0,
    "catapult_E": 5.0,
    "kT_stall": 0.5,
    "kT_peak": 0.5,
    "kT_a": 1.0,
    "kT_b": 1.0,
    "kT_c": 0.5,
    "alpha_max": 20.0,
    "J_without_friction": 2.0,
    "J_load_without_friction": 2.0,
    "J": 2.0,
    "K_fric_w": 10.0,
    "K_fric_0": 8.0,
    "J_load": 2.0,
    "M_max": 3.0,
    "corner": 5.0,
}
MISTAKE, OTHER = "half-sample lag", "backward difference"


def graded_answers(expected, given, truth=(), mistakes=None):
    """What one student gets, and each of the graded answers by its quantity."""
    known = {"expected": dict(expected), "truth": dict(truth), "mistakes": mistakes or {}}
    answers = {name: GivenAnswer(value, "") for name, value in given.items()}
    graded = grade(Submission("07", answers, "form"), {"07": known})
    return graded, {answer.question.name: answer for answer in graded.answers if answer.given is not None}


@pytest.mark.parametrize("name", TOLERANCES)
def test_an_answer_is_right_up_to_the_tolerance_and_no_further(name):
    reach = TOLERANCES[name] / 100.0
    for off, verdict in ((0.99, "right"), (-0.99, "right"), (1.01, "wrong"), (-1.01, "wrong")):
        _, found = graded_answers({name: -4.0}, {name: -4.0 * (1.0 + off * reach)})
        assert found[name].verdict == verdict, off


def test_every_quantity_is_promised_but_the_error_that_each_right_way_has_its_own_of():
    assert {question.name for question in QUESTIONS} - set(TOLERANCES) == {"E"}
    graded, found = graded_answers({"E": 1.0}, {"E": 7.0})
    assert found["E"].verdict == "not judged"
    assert (graded.right, graded.judged) == (0, len(TOLERANCES))


def test_where_zero_is_right_a_tenth_stands_for_it():
    """kT_b is 0 by the course's own condition: 1 % of 0.1 N*m/A**2 is allowed."""
    for value, verdict in ((0.99e-3, "right"), (-0.99e-3, "right"), (1.01e-3, "wrong")):
        assert graded_answers({"kT_b": 0.0}, {"kT_b": value})[1]["kT_b"].verdict == verdict


def test_an_answer_is_right_by_the_truth_or_by_the_courses_way():
    for value, verdict in ((22.0, "right"), (23.0, "right"), (22.5, "wrong")):
        assert graded_answers({"J": 22.0}, {"J": value}, truth={"J": 23.0})[1]["J"].verdict == verdict


def test_a_mistake_is_named_within_the_tolerance_of_its_figure():
    for off, named in ((1.99, True), (-1.99, True), (2.01, False)):
        _, found = graded_answers({"J": 20.0}, {"J": 30.0 * (1.0 + off / 100.0)}, mistakes={MISTAKE: [{"J": 30.0}]})
        assert (found["J"].mistake is not None) is named, off
        assert found["J"].mistake is None or found["J"].mistake.name == MISTAKE


def test_the_remaining_error_tells_two_mistakes_apart_that_give_the_same_answers():
    """E has no tolerance of its own: it is near a mistake's figure by 4 % of that."""
    ways = {MISTAKE: [{"J": 30.0, "E": 2.0}], OTHER: [{"J": 30.0, "E": 2.3}]}
    assert graded_answers({"J": 20.0}, {"J": 30.0, "E": 2.01}, mistakes=ways)[1]["J"].mistake.name == MISTAKE
    assert graded_answers({"J": 20.0}, {"J": 30.0, "E": 2.29}, mistakes=ways)[1]["J"].mistake.name == OTHER
    # J lies 1.5 % off the one's figure, 0.75 of its tolerance of 2 %; E lies off the other's by a little more, or less
    for off, named in ((0.031, MISTAKE), (0.029, OTHER)):
        ways = {MISTAKE: [{"J": 30.0, "E": 2.0}], OTHER: [{"J": 30.45, "E": 2.0 / (1.0 + off)}]}
        assert graded_answers({"J": 20.0}, {"J": 30.45, "E": 2.0}, mistakes=ways)[1]["J"].mistake.name == named


def test_distances_from_a_mistakes_figures_count_by_their_squares():
    """E is taken for right by nobody: the one mistake has both 0.6 off what is allowed, the other one of them 0.8."""
    ways = {MISTAKE: [{"J": 30.0 / 1.012, "E": 2.0 / 1.024}], OTHER: [{"J": 30.0, "E": 2.0 / 1.032}]}
    assert graded_answers({"J": 20.0}, {"J": 30.0, "E": 2.0}, mistakes=ways)[1]["J"].mistake.name == OTHER
    ways[OTHER] = [{"J": 30.0, "E": 2.0 / 1.036}]  # 0.9**2 is more than twice 0.6**2, and 0.9 less than twice 0.6
    assert graded_answers({"J": 20.0}, {"J": 30.0, "E": 2.0}, mistakes=ways)[1]["J"].mistake.name == MISTAKE


def test_the_mistake_that_explains_more_answers_is_named():
    ways = {MISTAKE: [{"J": 30.0}], OTHER: [{"J": 30.3, "K_fric_w": 2e-3}]}
    given = {"J": 30.0, "K_fric_w": 2e-3}
    _, found = graded_answers({"J": 20.0, "K_fric_w": 1e-3}, given, mistakes=ways)
    assert {answer.mistake.name for answer in found.values()} == {OTHER}


def test_an_answer_that_is_right_speaks_against_a_mistake_that_would_have_changed_it_no_less():
    """Of two with the same wrong figure the one is named that leaves what is right as it is."""
    ways = {MISTAKE: [{"J": 30.0, "K_fric_w": 5e-3}], OTHER: [{"J": 30.3, "K_fric_w": 1e-3}]}
    _, found = graded_answers({"J": 20.0, "K_fric_w": 1e-3}, {"J": 30.0, "K_fric_w": 1e-3}, mistakes=ways)
    assert found["J"].mistake.name == OTHER
    assert found["K_fric_w"].verdict == "right"
    assert found["K_fric_w"].mistake is None


def test_a_mistake_of_one_task_is_not_looked_for_in_another():
    ways = {MISTAKE: [{"J": 30.0, "M_max": 9.0}]}
    _, found = graded_answers({"J": 20.0, "M_max": 3.5}, {"J": 30.0, "M_max": 5.0}, mistakes=ways)
    assert found["J"].mistake.name == MISTAKE
    assert (found["M_max"].verdict, found["M_max"].mistake) == ("wrong", None)
    assert math.isnan(graded_answers({}, {"J": 1.0})[1]["J"].expected)
