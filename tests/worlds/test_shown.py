"""Facts that a camera shows only from certain places."""

from pathlib import Path

import pytest

from tests.ward import ward
from tpvqa.errors import WorldFileError
from tpvqa.observation import Observation
from tpvqa.pddl import Atom, Literal
from tpvqa.questions import QuestionBook, Way
from tpvqa.vlm import Reply
from tpvqa.vlm.oracle import Oracle
from tpvqa.vlm.protocol import VLM
from tpvqa.vlm.recorded import Recorded
from tpvqa.worlds.simulation import SimulatedTruth, Simulation
from tpvqa.worlds.world_file import WorldRules, load_world_file

TASK = ward("(in pump store) (in lamp hall) (needs anna pump)")
SHOWN = "shown: [{fact: '(in ?t ?r)', where: '(at ?r)'}]"
BOOK = QuestionBook(TASK)


def rules(text: str, folder: Path) -> WorldRules:
    path = folder / "world.yaml"
    path.write_text(text)
    return load_world_file(path, TASK)


def reply(vlm: VLM, *atom: str) -> Reply:
    question = BOOK.fact(Literal(Atom(atom[0], atom[1:])), way=Way.PRECONDITION)
    (answer,) = vlm.ask(Observation(time=0.0, look=1), [question])
    return answer.reply


def test_what_is_elsewhere_cannot_be_seen(tmp_path: Path) -> None:
    simulation = Simulation(TASK, rules(SHOWN, tmp_path), failure=0.0)
    truth = SimulatedTruth(simulation)
    oracle = Oracle(truth)
    assert reply(oracle, "in", "lamp", "hall") is Reply.YES
    assert reply(oracle, "in", "pump", "store") is Reply.CANNOT_SEE
    assert reply(oracle, "at", "store") is Reply.NO  # of which the file says nothing
    recorded = Recorded.from_spec("gpt-4.1-nano", truth=truth, task=TASK)
    assert reply(recorded, "in", "pump", "store") is Reply.CANNOT_SEE
    simulation.execute(TASK.action("go", ("hall", "store")))
    assert reply(oracle, "in", "pump", "store") is Reply.YES
    assert reply(oracle, "in", "lamp", "hall") is Reply.CANNOT_SEE


def test_the_first_rule_of_a_fact_counts(tmp_path: Path) -> None:
    text = """shown:
    - {fact: "(in lamp ?r)", where: ["(at ?r)", "(free)"]}
    - {fact: "(in ?t ?r)", where: "(at store)"}"""
    truth = SimulatedTruth(Simulation(TASK, rules(text, tmp_path)))
    assert reply(Oracle(truth), "in", "lamp", "hall") is Reply.YES
    assert reply(Oracle(truth), "in", "pump", "store") is Reply.CANNOT_SEE


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("shown: [{fact: '(in ?t ?r)', where: []}]", "name what has to hold"),
        ("shown: [{fact: '(in ?t ?r)'}]", "needs 'fact' and 'where'"),
        ("shown: [{fact: '(in ?t ?r)', where: '(at ?x)'}]", r"does not speak of \?x"),
        ("shown: [{fact: '(in ?t ?r)', where: '(nowhere ?r)'}]", "no predicate 'nowhere'"),
    ],
)
def test_what_does_not_fit_is_told_with_its_line(text: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(WorldFileError, match=told) as error:
        rules(text, tmp_path)
    assert "world.yaml:1" in str(error.value)
