"""What the report shows of a belief: which facts, which numbers, beside which truth."""

from html.parser import HTMLParser
from pathlib import Path
from typing import Literal

import pytest

from tests.episodes.believing import (
    DOUBTED,
    FIND,
    FLIPPED,
    PICK,
    UNSURE,
    all_followed,
    believing,
    decided,
    done,
    plan,
    started,
    without_belief,
)
from tpvqa.episodes.fact_words import words_of
from tpvqa.episodes.report import render_report, tell
from tpvqa.episodes.report.belief_chart import BeliefChart, Run, chart
from tpvqa.events import Event, Started
from tpvqa.events.events import Acted, Decided
from tpvqa.monitors import Decision


class Page(HTMLParser):
    """The facts that have a row in the chart, what points say, and all visible text."""

    def __init__(self, events: list[Event]):
        super().__init__()
        self.facts: list[str] = []
        self.titles: list[str] = []
        self.words: list[str] = []
        self.classes: set[str] = set()
        self._inside: list[str] = []
        self.feed(render_report(events, Path()))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self._inside.append(tag)
        self.classes |= set((given.get("class") or "").split())
        if fact := given.get("data-fact"):
            self.facts.append(fact)

    def handle_endtag(self, tag: str) -> None:
        while self._inside and self._inside.pop() != tag:
            pass

    def handle_data(self, data: str) -> None:
        if "style" not in self._inside:
            (self.titles if "title" in self._inside[-1:] else self.words).append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


def drawn(events: list[Event]) -> BeliefChart:
    found = chart(tell(events), str)
    assert found is not None
    return found


def test_the_facts_that_were_in_doubt_or_changed_side_have_a_row_each() -> None:
    assert Page(believing()).facts == [UNSURE, FLIPPED, DOUBTED]


def test_without_a_belief_there_is_no_chart() -> None:
    page = Page(without_belief(believing()))
    assert page.facts == []
    assert "Belief over time" not in page.text
    assert "Belief over time" in Page(believing()).text


def test_rows_say_words_and_points_say_numbers_and_truths() -> None:
    page = Page(believing())
    assert "bread in a robot's hand (left)" in page.text
    told = [title for title in page.titles if title.startswith("bread in a robot's hand (left)")]
    assert [title.splitlines()[0].partition(": ")[2] for title in told] == [
        "P = 0.001; in truth not true",
        "P = 0.001; in truth not true",
        "P = 0.600; in truth not true",
        "P = 0.600; in truth not true",
        "P = 0.970; in truth true",
    ]


def test_a_belief_on_the_wrong_side_is_marked_where_it_was() -> None:
    _, flipped, doubted = drawn(believing()).rows
    assert (flipped.wrong, flipped.true) == ([], [Run(1, 5)])
    assert (doubted.wrong, doubted.true) == ([Run(2, 4)], [Run(4, 5)])


def test_what_was_elsewhere_from_the_start_is_true_there() -> None:
    begun, *rest = believing()
    assert isinstance(begun, Started)
    elsewhere = begun.model_copy(update={"true_start": (*begun.initial, UNSURE)})
    (row,) = (row for row in drawn([elsewhere, *rest]).rows if row.fact == UNSURE)
    assert row.true == [Run(0, 5)]
    (row,) = (row for row in drawn([begun, *rest]).rows if row.fact == UNSURE)
    assert row.true == []


def test_where_the_world_tells_no_truth_none_is_shown() -> None:
    events = [
        event.model_copy(update={"truth": None}) if isinstance(event, Acted) else event
        for event in believing()
    ]
    page = Page(events)
    assert page.facts == [UNSURE, FLIPPED, DOUBTED]
    assert not any("in truth" in title for title in page.titles)
    assert "truth-band" not in page.classes
    assert "truth-band" in Page(believing()).classes


def test_truth_is_unknown_from_an_action_on_that_nobody_judged() -> None:
    events = believing()
    last = max(place for place, event in enumerate(events) if isinstance(event, Acted))
    events[last] = events[last].model_copy(update={"truth": None})
    assert drawn(events).rows[2].truths == (False, False, False, False, None)


def test_what_follows_from_axioms_is_not_called_untrue() -> None:
    domain = "(define (domain d) (:derived (near ?x) (and)))"
    events = [started(domain=domain), *believing()[1:]]
    _, flipped, doubted = drawn(events).rows
    assert set(flipped.truths) == {None}
    assert None not in doubted.truths


def test_actions_are_marked_before_the_decisions_that_follow_them() -> None:
    assert drawn(believing()).acts == [1, 2, 4]


def test_a_fact_that_a_plan_does_not_need_leaves_a_gap_in_its_line() -> None:
    events = [
        started(),
        plan(FIND, PICK),
        decided("before", 0, Decision.GO_ON, near=0.001, held=0.25),
        *done(0, 0),
        decided("after", 0, Decision.REPEAT, near=0.4),
        *done(0, 1),
        decided("after", 0, Decision.REPEAT, near=0.4, held=0.75),
    ]
    held = next(row for row in drawn(events).rows if row.fact == DOUBTED)
    assert held.line == "M0 75V75H1 M2 25V25H3"


def test_considered_plans_are_folded_away_and_are_no_replans() -> None:
    page, other = Page(believing()), Page(all_followed(believing()))
    assert "New plan" not in page.text
    assert other.text.count("New plan") == 2
    assert page.text.count("thought about 1 other plan") == 2
    assert "thought about" not in other.text
    story = tell(believing())
    assert [chapter.plan.plan for chapter in story.chapters if chapter.plan] == [(FIND, PICK)]
    assert [chapter.action for chapter in story.actions] == [FIND, PICK, PICK]


def test_beside_a_decision_stand_the_facts_in_doubt_or_changed() -> None:
    told = [
        [(each.fact, each.p, each.arrow) for each in phase.facts]
        for chapter in tell(believing()).actions
        for _, phase in chapter.phases
    ]
    assert told == [
        [(UNSURE, 0.3, "")],
        [(FLIPPED, 0.999, "▲1.00"), (UNSURE, 0.3, "")],
        [],
        [(DOUBTED, 0.6, "▲.60"), (UNSURE, 0.3, "")],
        [],  # as decided after the action before
        [(UNSURE, 0.3, ""), (DOUBTED, 0.97, "▲.37")],
    ]


def test_going_on_at_another_step_instead_of_acting_begins_a_chapter_of_its_own() -> None:
    events = [
        started(),
        plan(FIND, PICK),
        decided("before", 1, Decision.GO_ON, near=0.2),
        decided("before", 0, Decision.GO_ON, near=0.2),
        *done(0, 0),
    ]
    chapters = tell(events).actions
    assert [(each.action, each.acting is not None) for each in chapters] == [
        (PICK, False),
        (FIND, True),
    ]


@pytest.mark.parametrize(
    ("fact", "said"),
    [
        ("(on bread plate)", "bread on the plate"),
        ("(near tv)", "TV in the image"),
        ("(in_hand bread right)", "bread in a robot's hand (right)"),
        ("(of_another_version bread)", "(of_another_version bread)"),
    ],
)
def test_facts_are_said_as_they_are_asked_about(fact: str, said: str) -> None:
    assert words_of(started()).say(fact) == said


def test_without_a_questions_file_facts_are_said_by_their_names() -> None:
    unworded = started().model_copy(update={"questions": None})
    assert words_of(unworded).say("(in_hand bread left)") == "bread in hand (left)"


@pytest.mark.parametrize(
    ("question", "said"),
    [("Does the {c} stand open?", "fridge stands open"), ("Open, the {c}?", "opened(fridge)")],
)
def test_a_question_that_is_no_phrase_leaves_its_fact_an_atom(question: str, said: str) -> None:
    worded = started().model_copy(update={"questions": f'predicates: {{opened: "{question}"}}'})
    assert words_of(worded).say("(opened fridge)") == said


@pytest.mark.parametrize(
    ("when", "onto", "course"),
    [
        ("before", None, "go on"),
        ("after", None, "go on"),
        ("before", 2, "go on"),
        ("after", 3, "go on"),
        ("after", 2, "go back"),
        ("before", 0, "go back"),
        ("after", 5, "skip ahead"),
    ],
)
def test_going_on_elsewhere_is_shown_as_such(
    when: Literal["before", "after"], onto: int | None, course: str
) -> None:
    event = Decided(when=when, step=2, action="(a)", decision=Decision.GO_ON, reason="", onto=onto)
    assert event.course == course
    again = event.model_copy(update={"decision": Decision.REPEAT})
    assert again.course == "repeat"
