"""From where facts are shown, and what *cannot see* tells of the place."""

from math import isclose

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.ward import DOMAIN
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.belief.filtering.first import Prior
from tpvqa.belief.weighing.vantage import Vantage
from tpvqa.pddl import Atom, State, task_from_text
from tpvqa.vlm import Reply
from tpvqa.worlds.world_file import load_world_file

HALL, STORE, THEATRE = (Atom.parse(f"(at {room})") for room in ("hall", "store", "theatre"))
LAMP, PUMP = Atom.parse("(in lamp store)"), Atom.parse("(in pump hall)")
TASK = task_from_text(
    DOMAIN,
    """(define (problem lamps) (:domain ward)
 (:objects hall store theatre - room lamp pump - tool anna - patient)
 (:init (at hall) (free) (in lamp store) (in pump hall) (lies anna theatre) (needs anna lamp))
 (:goal (treated anna)))""",
)


@pytest.fixture
def half(tmp_path_factory: pytest.TempPathFactory) -> tuple[Belief, Vantage]:
    """It is in the hall or in the store, and things are shown in the room that they are in."""
    return believed(tmp_path_factory, 0.5)


def believed(folders: pytest.TempPathFactory, store: float) -> tuple[Belief, Vantage]:
    file = folders.mktemp("ward") / "world.yaml"
    file.write_text("shown: [{fact: '(in ?t ?r)', where: '(at ?r)'}]")
    rules = load_world_file(file, TASK)
    belief = Belief(FaultModel(TASK, rules))
    belief.begin([(TASK.init, 1 - store), (there(), store)])
    return belief, Vantage(belief, rules.shown)


def there() -> State:
    return frozenset(TASK.init - {HALL} | {STORE})


def test_who_cannot_see_is_probably_elsewhere(half: tuple[Belief, Vantage]) -> None:
    belief, vantage = half
    vantage.take((LAMP,), Reply.CANNOT_SEE)
    assert isclose(belief.probability(STORE), 0.1 / 0.8)
    vantage.take((LAMP,), Reply.CANNOT_SEE)  # the next look shows the same place
    assert isclose(belief.probability(STORE), 0.1 / 0.8)
    vantage.moved()
    vantage.take((LAMP,), Reply.CANNOT_SEE)
    assert belief.probability(STORE) < 0.1 / 0.8


def test_an_answer_tells_of_the_place_a_little(half: tuple[Belief, Vantage]) -> None:
    belief, vantage = half
    vantage.take((LAMP,), Reply.NO)
    assert isclose(belief.probability(STORE), 0.9 / 1.2)
    vantage.take((LAMP,), Reply.YES)
    assert isclose(belief.probability(STORE), 0.9 / 1.2)


def test_a_reply_that_is_missing_says_nothing(half: tuple[Belief, Vantage]) -> None:
    belief, vantage = half
    vantage.take((LAMP,), Reply.UNKNOWN)
    vantage.take((STORE,), Reply.CANNOT_SEE)  # shown everywhere
    vantage.take((LAMP, PUMP), Reply.CANNOT_SEE)  # shown in two places
    assert belief.probability(STORE) == 0.5


def test_where_nothing_is_ever_seen_that_tells_less_and_less(
    half: tuple[Belief, Vantage],
) -> None:
    """A VLM that says so wherever it is does not lead the robot astray for long."""
    belief, vantage = half
    odds = []
    for _ in range(40):
        before = belief.probability(STORE)
        vantage.moved()
        vantage.take((LAMP,), Reply.CANNOT_SEE)
        after = belief.probability(STORE)
        odds.append(before / (1 - before) * (1 - after) / after)
        belief.begin([(TASK.init, 0.2), (there(), 0.8)])
    assert isclose(odds[0], 7)
    assert odds[-1] < 2
    assert odds == sorted(odds, reverse=True)


@given(store=st.floats(0.001, 0.999))
def test_asked_is_what_may_be_shown_here(
    tmp_path_factory: pytest.TempPathFactory, store: float
) -> None:
    belief, vantage = believed(tmp_path_factory, store)
    hall, there = belief.probability(HALL), belief.probability(STORE)
    assert vantage.shows((LAMP,)) == (there >= 0.1 * max(hall, there))
    assert vantage.shows((PUMP,)) == (hall >= 0.1 * max(hall, there))
    assert vantage.shows((LAMP, PUMP))
    assert vantage.shows((STORE,))
    assert not vantage.shows((Atom.parse("(in lamp theatre)"),))


def test_who_is_anywhere_asks_about_everything(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Each of many places has less than a tenth, and nothing else would tell where it is."""
    rooms = [f"room{number}" for number in range(30)]
    task = task_from_text(
        DOMAIN,
        f"""(define (problem anywhere) (:domain ward)
 (:objects {" ".join(rooms)} - room lamp - tool anna - patient)
 (:init (free) (in lamp room3) (oneof {" ".join(f"(at {room})" for room in rooms)})
   (lies anna room1) (needs anna lamp))
 (:goal (treated anna)))""",
    )
    file = tmp_path_factory.mktemp("ward") / "world.yaml"
    file.write_text("shown: [{fact: '(in ?t ?r)', where: '(at ?r)'}]")
    rules = load_world_file(file, task)
    vantage, prior = Vantage(Belief(FaultModel(task, rules)), rules.shown), Prior(task)
    assert all(vantage.shows((Atom("in", ("lamp", room)),), prior) for room in rooms)


def test_places_of_other_rules_are_no_measure(tmp_path_factory: pytest.TempPathFactory) -> None:
    """That a hand is certainly free says nothing of the room in which the robot is."""
    file = tmp_path_factory.mktemp("ward") / "world.yaml"
    file.write_text(
        "shown: [{fact: '(in ?t ?r)', where: '(at ?r)'}, {fact: '(treated ?p)', where: '(free)'}]"
    )
    rules = load_world_file(file, TASK)
    belief = Belief(FaultModel(TASK, rules))
    others = [(there() - {STORE} | {THEATRE}, 0.08), (there(), 0.07)]
    belief.begin([(TASK.init - {HALL}, 0.85), *others])  # between two rooms
    assert Vantage(belief, rules.shown).shows((LAMP,))
