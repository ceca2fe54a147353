"""Scores of a VLM that sees everything, and of one that errs in a known way."""

from collections.abc import Sequence

from tests.household.training.household import facts, shows
from tpvqa.observation import Observation
from tpvqa.questions import Question
from tpvqa.vlm import Answer, Reply
from tpvqa_household.kitchen.household import Household
from tpvqa_household.training.asking import Asking
from tpvqa_household.training.facts import FactTable
from tpvqa_household.training.labels import Label, Labels
from tpvqa_household.training.scoring import Case, report, score, tables
from tpvqa_household.training.wordings import wordings

ASKING = Asking.about("clean_dishes")
HOUSEHOLD = Household(
    near="table",
    held={"left": "apple"},
    where={"plate": "table", "bread": "table", "knife": "counter"},
)
CASE = Case(
    Observation(0, 0.0),
    {
        **facts(HOUSEHOLD, hidden=("(opened fridge)", "(turned_on tv)")),
        **shows("table", "plate", "bread", "apple"),
    },
    "a group",
)


class Seer:
    """Answers every wording rightly, but what it is told to get wrong."""

    name = "seer"

    def __init__(self, *, deny: str = "") -> None:
        labels = Labels(FactTable.of([CASE.facts]), ASKING.actions).of(ASKING.subjects)[0]
        self.replies: dict[str, Reply] = {}
        for subject, label in zip(ASKING.subjects, labels, strict=True):
            for wording in wordings(subject):
                yes = (label == Label.YES) != wording.inverted
                reply = Reply.YES if yes else Reply.NO
                if label == Label.CANNOT_SEE:
                    reply = Reply.CANNOT_SEE
                if subject.name == deny and subject.form == "fact":
                    reply = Reply.NO
                self.replies[wording.text] = reply

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        return [
            Answer(q, self.replies[q.text], p_yes=float(self.replies[q.text] is Reply.YES))
            for q in questions
        ]


def test_who_sees_everything_is_right_in_every_table() -> None:
    rows = list(score(Seer(), [CASE], ASKING, every_wording=True))
    for _, table in tables(rows, ASKING):
        for metrics in table.values():
            assert metrics.accuracy in (1.0, None)
            assert metrics.cannot_see_rightly in (1.0, None)
    assert {row.subject for row in rows} == set(ASKING.subjects)


def test_one_denied_predicate_shows_where_it_belongs() -> None:
    rows = list(score(Seer(deny="in_hand"), [CASE], ASKING))
    found = dict(tables(rows, ASKING))
    assert found["predicate"]["in_hand"].false_negative_rate == 1.0
    assert found["predicate"]["in_hand"].accuracy == 0.75
    assert found["predicate"]["on"].accuracy == 1.0
    assert found["object"]["apple"].accuracy is not None
    assert found["object"]["apple"].accuracy < 1.0
    assert found["way of asking"]["possible"].accuracy == 1.0


def test_the_report_names_groups_and_figures() -> None:
    text = report(list(score(Seer(), [CASE], ASKING)), ASKING)
    assert "## a group" in text
    assert "| preconditions |" in text
