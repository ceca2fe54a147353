"""What nothing shows is asked about by what the same action does besides."""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Ended, Event
from tpvqa.events.events import Acting, Answered, Asked
from tpvqa.vlm import Reply

DOMAIN = """
(define (domain post) (:requirements :strips)
  (:predicates (here ?p) (labelled ?p) (booked ?p) (paid ?p) (sent ?p))
  (:action label :parameters (?p) :precondition (here ?p)
    :effect (and (labelled ?p) (booked ?p)))
  (:action pay :parameters (?p) :precondition (and (here ?p) (booked ?p)) :effect (paid ?p))
  (:action send :parameters (?p) :precondition (paid ?p) :effect (and (sent ?p) (not (here ?p)))))
"""
PROBLEM = """
(define (problem one) (:domain post) (:objects parcel) (:init (here parcel))
  (:goal (and (booked parcel) (sent parcel))))
"""
QUESTIONS = """
predicates:
  here: "Is the {p} here?"
  sent: "Is the {p} gone?"
  labelled: "Does the {p} bear a label?"
never_asked:
  - fact: "(booked ?p)"
    because: it is in the computer alone
  - fact: "(paid ?p)"
    because: so is that
"""


def test_that_it_bears_its_label_tells_that_it_is_booked(tmp_path: Path) -> None:
    """Where nothing else was done since, it is hardly labelled again without a no."""
    for name, text in (("domain.pddl", DOMAIN), ("problem.pddl", PROBLEM)):
        (tmp_path / name).write_text(text)
    (tmp_path / "questions.yaml").write_text(QUESTIONS)
    files = {"domain": "domain.pddl", "problem": "problem.pddl", "questions": "questions.yaml"}
    before: list[list[Reply]] = []
    for seed in range(12):
        config = TrialConfig.model_validate(
            {
                "task": {name: str(tmp_path / file) for name, file in files.items()},
                "vlm": "oracle",
                "monitor": "belief",
                "seed": seed,
            }
        )
        writer = MemoryWriter()
        with Trial(config) as trial:
            trial.run(writer)
        end = writer.events[-1]
        assert isinstance(end, Ended)
        assert end.completed
        before += _told_before_it_was_labelled_again(writer.events)
    assert len(before) >= 3
    assert all(Reply.YES not in told for told in before)
    assert sum(Reply.NO in told for told in before) >= 0.75 * len(before)


def _told_before_it_was_labelled_again(events: Sequence[Event]) -> list[list[Reply]]:
    """The answers about the label between two labellings with no other action between them."""
    acted = [(n, event.action.name) for n, event in enumerate(events) if isinstance(event, Acting)]
    told = [
        (n, answer.reply)
        for n, (event, after) in enumerate(pairwise(events))
        if isinstance(event, Asked) and isinstance(after, Answered)
        for question, answer in zip(event.questions, after.answers, strict=True)
        if "label" in question.text
    ]
    return [
        [reply for n, reply in told if first < n < again]
        for (first, done), (again, then) in pairwise(acted)
        if done == then == "label"
    ]
