"""What nothing shows is asked about by what the same action does besides."""

from itertools import pairwise
from pathlib import Path

import pytest

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Ended
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


@pytest.mark.parametrize("seed", range(4))
def test_that_it_bears_its_label_tells_that_it_is_booked(tmp_path: Path, seed: int) -> None:
    for name, text in (("domain.pddl", DOMAIN), ("problem.pddl", PROBLEM)):
        (tmp_path / name).write_text(text)
    (tmp_path / "questions.yaml").write_text(QUESTIONS)
    files = {"domain": "domain.pddl", "problem": "problem.pddl", "questions": "questions.yaml"}
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
    labels = [
        n
        for n, event in enumerate(writer.events)
        if isinstance(event, Acting) and event.action.name == "label"
    ]
    told = [
        (n, answer.reply)
        for n, (event, after) in enumerate(pairwise(writer.events))
        if isinstance(event, Asked) and isinstance(after, Answered)
        for question, answer in zip(event.questions, after.answers, strict=True)
        if "label" in question.text
    ]
    assert labels
    for done, next_one in pairwise(labels):
        assert [reply for n, reply in told if done < n < next_one][-1:] == [Reply.NO]
