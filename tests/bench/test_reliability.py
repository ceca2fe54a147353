"""What is said of a calibration that may do harm."""

import pytest

from tpvqa.bench.reliability import Line, doubts


def line(before: float, after: float | None, *, answers: int = 40, right: float = 0.8) -> Line:
    return Line(None, None, answers, 0.0, right, right, 1 - right, before, after)


@pytest.mark.parametrize(
    "fine",
    [line(0.2, 0.05), line(0.05, 0.06), line(0.2, None), line(0.05, 0.3, answers=6)],
)
def test_what_did_no_harm_is_not_told(fine: Line) -> None:
    assert doubts(fine) == []


def test_what_made_answers_less_reliable_is_told() -> None:
    (said,) = doubts(line(0.05, 0.3))
    assert said.startswith("calibrated, the answers are less reliable")
    assert "(0.300 for 0.050): 40 answers are too few" in said


def test_answers_that_say_the_contrary_are_told() -> None:
    (said,) = doubts(line(0.8, 0.1, right=0.2))
    assert said.startswith("yes was said more often where no was right (0.80)")
