"""Things that may be elsewhere than the problem says."""

from math import isclose
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.answers.kinds import FRESH
from tpvqa.belief.answers.trust import Trust
from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.doubts import Doubts, moved
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.belief.filtering.priors import Priors
from tpvqa.belief.filtering.starts import drawn_start, opened
from tpvqa.belief.states.places import further_places, things
from tpvqa.belief.states.surprise import Surprise
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.pddl import Atom, load_task
from tpvqa.questions.question import FactQuestion, Way
from tpvqa.vlm import Answer, Reply
from tpvqa.worlds.world_file import WorldRules

TASK = load_task("serve_breakfast")
COUNTER, TABLE = Atom.parse("(on bread counter)"), Atom.parse("(on bread table)")
FRIDGE = Atom.parse("(on bread fridge)")
TAKE = next(
    action
    for action in TASK.ground_actions()
    if action.name == "pick_up" and action.arguments[:2] == ("bread", "counter")
)


def test_things_are_what_is_somewhere() -> None:
    stated = {str(thing.stated.pddl()) for thing in things(TASK)}
    assert stated == {
        "(on apple fridge)",
        "(on bread counter)",
        "(on knife counter)",
        "(on plate table)",
    }


def test_a_thing_may_be_where_another_one_is() -> None:
    assert FRIDGE not in TASK.atoms() | TASK.init
    assert FRIDGE in further_places(TASK)
    assert not any("tv" in atom.arguments[1:] for atom in further_places(TASK))
    wider = opened(TASK, Priors(elsewhere=0.02))
    assert wider.init == TASK.init
    assert wider.atoms() > TASK.atoms()
    assert ("pick_up", "bread", "fridge", "left") in wider.reachable_actions
    flips = Surprise(wider).flips(wider.init, (COUNTER,))
    assert any(FRIDGE in state for state in flips)
    assert opened(TASK, Priors()) is TASK


def test_a_doubt_is_weighed_by_answers_and_given_once() -> None:
    doubts = Doubts(TASK, 0.1)
    doubts.learn((COUNTER,), 0.8, 0.2)
    doubts.learn((TABLE,), 0.1, 0.9)  # says nothing of the counter
    doubts.leave()
    expected = 0.1 * 0.2 / (0.1 * 0.2 + 0.9 * 0.8)
    assert isclose(doubts.of((COUNTER,), held=True), expected)
    doubts.give((COUNTER,))
    assert doubts.of((COUNTER,), held=True) == 0


def test_an_action_that_rests_on_a_place_takes_its_doubt_in_once() -> None:
    belief = Belief(FaultModel(TASK))
    evidence = Evidence(belief, Calibration.default(), None, doubts=Doubts(TASK, 0.1))
    evidence.rests_on(TAKE)
    assert isclose(belief.probability(COUNTER), 0.9)
    assert belief.probability(TABLE) > 0
    evidence.rests_on(TAKE)
    assert isclose(belief.probability(COUNTER), 0.9)


def doubted(*replies: Reply) -> float:
    """How far it is doubted that the bread is where it cannot be picked up, after some answers."""
    belief = Belief(FaultModel(TASK))
    evidence = Evidence(belief, Calibration.default(), None)
    for look, reply in enumerate(replies):
        asked = FactQuestion("Is the bread there?", Way.PRECONDITION, COUNTER)
        evidence.take(asked, Answer(asked, reply), look, None)
    before = belief.probability(COUNTER)
    evidence.rests_on(TAKE, dead=0.9)
    return (before - belief.probability(COUNTER)) / before


def test_what_fails_in_vain_may_need_what_does_not_hold() -> None:
    """As well as that it never works; less where it was said last that it holds."""
    assert 0.1 < doubted() < 0.3
    assert doubted(Reply.YES) < doubted() / 2
    assert doubted(Reply.NO, Reply.NO) > doubted() / 2


@given(
    st.lists(st.tuples(st.booleans(), st.sampled_from([COUNTER, TABLE])), max_size=8),
    st.sampled_from([None, 0]),
)
def test_it_is_the_same_whether_a_doubt_is_taken_in_before_answers_or_after(
    answers: list[tuple[bool, Atom]], trusted: int | None
) -> None:
    """What was said of it in this scene is not forgotten (Bayes' rule knows no order)."""
    likely = []
    for early in (True, False):
        belief = Belief(FaultModel(TASK), smallest=0.0)
        calibration = Calibration.default().model_copy(update={"pairs_same_view": 10**9})
        trust = None if trusted is None else Trust.after(trusted)
        doubts = Doubts(TASK, 0.1)
        evidence = Evidence(belief, calibration, trust, unexplained=0.0, doubts=doubts)
        for look in range(len(answers) + 1):
            if look == (0 if early else len(answers)):
                evidence.rests_on(TAKE)
            if look < len(answers):
                yes, atom = answers[look]
                asked = FactQuestion(f"Is it true that {atom}?", Way.PRECONDITION, atom)
                evidence.take(asked, Answer(asked, Reply.YES if yes else Reply.NO), look, None)
        likely.append((belief.probability(COUNTER), belief.probability(TABLE)))
    assert likely[0] == pytest.approx(likely[1], rel=1e-6)


@pytest.mark.parametrize(
    ("yeses", "trust"), [(0, None), (4, None), (8, None), (4, Trust.after(10**6))]
)
def test_what_many_noes_say_is_believed_after_yeses_too(yeses: int, trust: Trust | None) -> None:
    belief = Belief(FaultModel(TASK))
    calibration = Calibration.default().model_copy(update={"lasting": FRESH})
    evidence = Evidence(belief, calibration, trust, doubts=Doubts(TASK))
    asked = FactQuestion("Is the bread there?", Way.PRECONDITION, COUNTER)
    for look in range(yeses + 60):
        reply = Reply.YES if look < yeses else Reply.NO
        evidence.take(asked, Answer(asked, reply), look, None)
    assert belief.probability(COUNTER) < 0.5


def test_an_answer_that_agrees_leaves_a_doubt_for_the_next_scene() -> None:
    belief, doubts = Belief(FaultModel(TASK)), Doubts(TASK, 0.1)
    evidence = Evidence(belief, Calibration.default(), None, doubts=doubts)
    asked = FactQuestion("Is the bread there?", Way.PRECONDITION, COUNTER)
    evidence.take(asked, Answer(asked, Reply.YES), 0, None)
    assert isclose(doubts.gone(COUNTER), 0.1)  # as in this scene the belief weighs it itself
    evidence.acted()
    assert 0.01 < doubts.gone(COUNTER) < 0.05


def test_another_place_has_its_share_of_a_doubt() -> None:
    (bread,) = (thing for thing in things(TASK) if thing.stated == COUNTER)
    assert isclose(Doubts(TASK, 0.1).of((TABLE,), held=False), 0.1 / (len(bread.places) - 1))
    assert Doubts(TASK, 0.1).of((Atom.parse("(near sink)"),), held=True) == 0


def test_worlds_move_things_as_often_as_they_are_doubted() -> None:
    surprise, random = Surprise(TASK), Random(3)
    states = [moved(TASK, TASK.init, 0.25, surprise, random) for _ in range(200)]
    assert 0.15 < sum(COUNTER not in state for state in states) / 200 < 0.35
    groups = [group.atoms for group in TASK.mutex_groups if group.exactly_one]
    assert all(len(state & group) == 1 for state in states for group in groups)
    assert moved(TASK, TASK.init, 0.0, surprise, random) == TASK.init


def test_a_world_without_doubts_begins_as_the_problem_says() -> None:
    assert drawn_start(TASK, Priors(), WorldRules(), 0, 0) is None
    assert drawn_start(TASK, Priors(nothing_known=True), WorldRules(), 0, 0) is None
    drawn = {drawn_start(TASK, Priors(elsewhere=0.3), WorldRules(), 0, n) for n in range(10)}
    assert len(drawn) > 2
