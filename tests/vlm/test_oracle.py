"""The noise model: how often it errs, when it repeats itself, what it is given."""

import json
from collections.abc import Iterable, Sequence
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.doubles import made
from tpvqa.errors import EpisodeError, PluginError
from tpvqa.observation import Observation
from tpvqa.pddl import Action, Atom, Conjunction
from tpvqa.questions import ActionQuestion, ActionWay, FactQuestion, Question, Way
from tpvqa.vlm import VLM, Reply, TruthSource
from tpvqa.vlm.oracle import Oracle

CLEAN = FactQuestion("Is the plate clean?", Way.EFFECT, Atom("clean", ("plate",)))
WASH = Action("wash", ("plate",), Conjunction(), ())
PROBABILITY = st.floats(0, 1)


class Truth:
    """What is true, as a test says."""

    def __init__(self, *facts: Atom, possible: bool = True, successful: bool = True) -> None:
        self.facts = set(facts)
        self.is_possible, self.is_successful = possible, successful

    def holds(self, atom: Atom) -> bool:
        return atom in self.facts

    def visible(self, atom: Atom) -> bool:
        return True

    def scene(self) -> str:
        return str(sorted(map(str, self.facts)))

    def possible(self, action: Action) -> bool:
        return self.is_possible

    def successful(self, action: Action) -> bool:
        return self.is_successful


def look(number: int) -> Observation:
    return Observation(look=number, time=float(number))


def facts(count: int) -> list[FactQuestion]:
    return [FactQuestion(f"Is it {n}?", Way.EFFECT, Atom("is", (str(n),))) for n in range(count)]


def said(oracle: Oracle, looks: Iterable[int], questions: Sequence[Question]) -> list[list[bool]]:
    return [[answer.reply is Reply.YES for answer in oracle.ask(look(n), questions)] for n in looks]


def test_it_is_a_vlm_that_knows_the_truth() -> None:
    oracle = Oracle(Truth(*(each.atom for each in facts(20)[::2])))
    assert isinstance(oracle, VLM)
    assert isinstance(Truth(), TruthSource)
    assert said(oracle, [0], facts(20)) == [[n % 2 == 0 for n in range(20)]]


@pytest.mark.parametrize("possible", [True, False])
@pytest.mark.parametrize("successful", [True, False])
def test_whole_actions_are_judged_by_precondition_and_effects(
    possible: bool, successful: bool
) -> None:
    oracle = Oracle(Truth(possible=possible, successful=successful))
    right: dict[ActionWay, bool] = {
        Way.POSSIBLE: possible,
        Way.SUCCESSFUL: successful,
        Way.DID: successful,
    }
    asked = [ActionQuestion(f"{way.value}?", way, WASH) for way in right]
    assert said(oracle, [0], asked) == [list(right.values())]


@pytest.mark.parametrize("accuracy", [0.0, 0.6, 0.8, 0.95, 1.0])
def test_it_errs_at_its_rate(accuracy: float) -> None:
    oracle = Oracle(Truth(), accuracy=accuracy, seed=3)
    wrong = [yes for row in said(oracle, range(50), facts(100)) for yes in row]
    # Four standard errors of 5,000 draws.
    assert sum(wrong) / 5000 == pytest.approx(
        1 - accuracy, abs=4 * (accuracy * (1 - accuracy) / 5000) ** 0.5
    )


@pytest.mark.parametrize("rho", [0.0, 0.5, 1.0])
def test_it_repeats_its_last_answer_about_an_unchanged_fact(rho: float) -> None:
    oracle = Oracle(Truth(), accuracy=0.5, rho=rho, seed=3)
    rows = said(oracle, range(50), facts(100))
    same = [a == b for before, after in pairwise(rows) for a, b in zip(before, after, strict=True)]
    # A fresh answer agrees with the last one half of the time.
    assert sum(same) / len(same) == pytest.approx(rho + (1 - rho) / 2, abs=0.03)
    right = [not yes for row in rows for yes in row]
    assert sum(right) / len(right) == pytest.approx(0.5, abs=0.1 if rho == 1 else 0.05)


def test_a_changed_fact_is_drawn_afresh() -> None:
    truth = Truth()
    oracle = Oracle(truth, accuracy=0.8, rho=1.0, seed=1)
    (before,) = said(oracle, [0], facts(500))
    truth.facts = {each.atom for each in facts(500)}
    (after,) = said(oracle, [1], facts(500))
    assert sum(before) / 500 == pytest.approx(0.2, abs=0.07)
    assert sum(after) / 500 == pytest.approx(0.8, abs=0.07)
    (again,) = said(oracle, [2], facts(500))
    assert again == after


@given(PROBABILITY, PROBABILITY, st.integers(0, 5), st.lists(st.integers(0, 9), min_size=1))
def test_the_same_question_gets_the_same_answer_within_a_look(
    accuracy: float, rho: float, seed: int, picked: list[int]
) -> None:
    oracle = Oracle(Truth(), accuracy=accuracy, rho=rho, seed=seed)
    asked = facts(10)
    for number in range(3):
        first = said(oracle, [number], asked)
        assert said(oracle, [number], [asked[n] for n in picked]) == [[first[0][n] for n in picked]]


def test_two_facts_in_the_same_words_get_the_same_answer_within_a_look() -> None:
    left, right = (Atom("in_hand", ("plate", hand)) for hand in ("left", "right"))
    asked = [FactQuestion("Is the plate in a hand?", Way.EFFECT, atom) for atom in (left, right)]
    oracle = Oracle(Truth(left))
    assert said(oracle, [0], asked) == [[True, True]]
    assert said(oracle, [1], asked[::-1]) == [[False, False]]


@given(PROBABILITY, st.integers(0, 5))
def test_an_answer_does_not_depend_on_what_else_was_asked(accuracy: float, seed: int) -> None:
    alone = Oracle(Truth(), accuracy=accuracy, seed=seed)
    among = Oracle(Truth(), accuracy=accuracy, seed=seed)
    asked = facts(8)
    assert said(alone, [4], asked[5:6])[0] == said(among, range(5), asked[::-1])[4][2:3]


@given(PROBABILITY, PROBABILITY)
def test_p_yes_is_how_reliable_it_is(accuracy: float, rho: float) -> None:
    (answer,) = Oracle(Truth(), accuracy=accuracy, rho=rho).ask(look(0), [CLEAN])
    yes = answer.reply is Reply.YES
    assert answer.p_yes == (accuracy if yes else 1 - accuracy)
    assert answer.source == "oracle"


def test_seed_and_episode_make_other_errors() -> None:
    def errors(seed: int, episode: int) -> list[list[bool]]:
        return said(Oracle(Truth(), accuracy=0.5, seed=seed, episode=episode), [0], facts(64))

    assert errors(1, 0) == errors(1, 0)
    assert errors(1, 0) != errors(2, 0)
    assert errors(1, 0) != errors(1, 1)


@settings(max_examples=30)
@given(PROBABILITY, st.integers(0, 9), st.lists(st.sets(st.integers(0, 5)), max_size=10))
def test_a_restored_oracle_goes_on_as_the_unbroken_one(
    rho: float, cut: int, trues: list[set[int]]
) -> None:
    def run(cuts: set[int]) -> list[list[bool]]:
        truth = Truth()
        oracle = Oracle(truth, accuracy=0.6, rho=rho, seed=1)
        rows = []
        for number, true in enumerate(trues):
            truth.facts = {Atom("is", (str(n),)) for n in true}
            if number in cuts:
                kept = json.loads(json.dumps(oracle.snapshot()))
                oracle = Oracle(truth, accuracy=0.6, rho=rho, seed=1)
                oracle.restore(kept)
            rows += said(oracle, [number], facts(6))
        return rows

    assert run({cut}) == run(set())


@pytest.mark.parametrize("damaged", [{}, {"answers": [{"text": "a"}]}, {"answers": 3}])
def test_a_damaged_snapshot_is_an_error(damaged: dict[str, object]) -> None:
    with pytest.raises(EpisodeError):
        Oracle(Truth()).restore(damaged)


@pytest.mark.parametrize(
    ("spec", "accuracy", "rho", "name"),
    [
        ("oracle", 1.0, 0.0, "oracle:1"),
        ("oracle:0.8", 0.8, 0.0, "oracle:0.8"),
        ("oracle:0.8:0.5", 0.8, 0.5, "oracle:0.8:0.5"),
        ("oracle:0.8:0:0.74", 0.8, 0.0, "oracle:0.8:0:0.74"),
    ],
)
def test_its_specifications(spec: str, accuracy: float, rho: float, name: str) -> None:
    oracle = made(spec, truth=Truth(), seed=1, episode=2, base_url=None)
    assert (oracle.accuracy, oracle.rho, oracle.name) == (accuracy, rho, name)


@pytest.mark.parametrize(
    "spec",
    [
        "oracle:2",
        "oracle:x",
        "oracle:nan",
        "oracle:-0.1",
        "oracle:0.8:7",
        "oracle:1:1:2",
        "oracle:1:1:1:1",
    ],
)
def test_a_wrong_specification_says_what_to_write(spec: str) -> None:
    with pytest.raises(PluginError, match="oracle:ACCURACY"):
        made(spec, truth=Truth())


def test_without_a_simulated_world_there_is_no_truth() -> None:
    with pytest.raises(PluginError, match="noise model"):
        made("oracle:0.8")
