"""What is said of a calibration that may do harm."""

import pytest

from tpvqa.bench.reliability import Line, doubts, one_sided


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


def test_what_a_file_holds_besides_is_not_thrown_away_with_it() -> None:
    (said,) = doubts(line(0.05, 0.3), besides=True)
    assert "its counted faults and what sensors and reports are worth still help" in said
    assert "do without this calibration" in doubts(line(0.05, 0.3))[0]


def test_answers_at_chance_are_told() -> None:
    (said,) = doubts(line(0.3, 0.1, right=0.52))
    assert said.startswith("the answers are no better than chance: yes was said in 0.52 where")
    one = Line(None, None, 12, 0.0, 0.5, 0.5, None, 0.3, 0.1)
    (said,) = doubts(one)
    assert said.startswith("the answers are no better than chance: 0.50 of them are right")


def test_labels_that_all_say_the_same_are_told_with_what_to_label() -> None:
    def of(predicate: str | None, yes: float | None, no: float | None) -> Line:
        return Line(None, predicate, 5, 0.0, 0.9, yes, no, 0.1, 0.1)

    table = [of("lit", 0.9, None), of("clean", 0.9, 0.1), of("open", None, 0.1), of(None, 0.9, 0.1)]
    no, yes = one_sided(table)
    assert no.startswith("no label says no of lit: what the VLM answers where no is right")
    assert yes.startswith("no label says yes of open:")
    assert "Next, label looks at which yes is right" in yes
    (said,) = one_sided([of("lit", 0.9, None), of(None, 0.9, None)])
    assert said.startswith("no label says no of all questions")
    assert one_sided([of("clean", 0.9, 0.1), of(None, 0.9, 0.1)]) == []
