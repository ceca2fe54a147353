"""Noise models with one flaw: what is wrong, how often, and what they say of it."""

import pytest

from tests.doubles import made
from tests.vlm.scene_truth import OlderTruth, SceneTruth
from tpvqa.errors import PluginError, TpvqaError, UnknownNameError
from tpvqa.observation import Observation
from tpvqa.pddl import Atom, Task, load_task
from tpvqa.plugins import Kind, is_plain
from tpvqa.questions import FactQuestion, Question, Way
from tpvqa.vlm import VLM, Answer, Reply
from tpvqa.worlds.simulation import SimulatedTruth, Simulation

LOOKS = 1500


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task("clean_dishes")


def fact(predicate: str, *arguments: str) -> FactQuestion:
    atom = Atom(predicate, arguments)
    return FactQuestion(f"Is it so that {atom}?", Way.EFFECT, atom)


MANY = [fact("on", "plate", str(n)) for n in range(600)]


def rate(vlm: VLM, question: Question) -> float:
    asked = (vlm.ask(Observation(look=n, time=0.0), [question])[0] for n in range(LOOKS))
    return sum(answer.reply is Reply.YES for answer in asked) / LOOKS


def always_wrong(vlm: VLM) -> set[str]:
    """The questions of `MANY`, of which none is true, that get yes at each of four looks."""
    looks = [vlm.ask(Observation(look=n, time=0.0), MANY) for n in range(4)]
    return {
        answers[0].question.text
        for answers in zip(*looks, strict=True)
        if all(answer.reply is Reply.YES for answer in answers)
    }


def test_a_share_of_the_questions_is_always_misread(task: Task) -> None:
    vlm = made("flawed:misread:0.1:0.95", truth=SceneTruth(), task=task, seed=1)
    wrong = always_wrong(vlm)
    assert len(wrong) == pytest.approx(60, abs=4 * 7.4)
    (well,) = (each for each in MANY[:1] if each.text not in wrong)
    assert rate(vlm, well) == pytest.approx(0.05, abs=0.025)


@pytest.mark.parametrize(("word", "same"), [("", False), (":same", True)])
def test_which_are_misread_is_of_the_trial_or_of_the_seed(
    word: str, same: bool, task: Task
) -> None:
    def wrong(seed: int, episode: int) -> set[str]:
        spec = f"flawed:misread:0.1:1{word}"
        vlm = made(spec, truth=SceneTruth(), task=task, seed=seed, episode=episode)
        return always_wrong(vlm)

    assert (wrong(1, 0) == wrong(1, 7)) is same
    assert wrong(1, 0) == wrong(1, 0)
    assert wrong(1, 0) != wrong(2, 0)


def test_the_same_questions_can_be_drawn_again_and_again(task: Task) -> None:
    def wrong(number: str, episode: int = 0) -> set[str]:
        spec = f"flawed:misread:0.1:1:same{number}"
        vlm = made(spec, truth=SceneTruth(), task=task, seed=1, episode=episode)
        return always_wrong(vlm)

    assert wrong(":3") == wrong(":3", episode=9)
    assert len({frozenset(wrong(number)) for number in ("", ":0", ":1", ":2")}) == 4


@pytest.mark.parametrize("true", [True, False])
def test_one_predicate_is_biased_and_the_others_are_not(true: bool, task: Task) -> None:
    biased, other = fact("on", "plate", "table"), fact("clean", "plate")
    truth = SceneTruth({biased.atom, other.atom} if true else ())
    vlm = made("flawed:biased:On:0.9:0.5", truth=truth, task=task, seed=1)
    assert rate(vlm, biased) == pytest.approx(0.9 if true else 0.5, abs=0.052)
    assert rate(vlm, other) == pytest.approx(0.8 if true else 0.2, abs=0.042)


def test_a_useless_one_tosses_a_coin_and_claims_to_know(task: Task) -> None:
    question = fact("clean", "plate")
    vlm = made("flawed:useless", truth=SceneTruth({question.atom}), task=task, seed=1)
    assert rate(vlm, question) == pytest.approx(0.5, abs=0.052)
    (answer,) = vlm.ask(Observation(look=0, time=0.0), [question])
    assert answer.p_yes == pytest.approx(0.8 if answer.reply is Reply.YES else 0.2)


def test_a_late_one_answers_as_it_was_before_the_last_action(task: Task) -> None:
    simulation = Simulation(task, failure=0)
    vlm = made("flawed:late:1", truth=SimulatedTruth(simulation), task=task)
    question, looks = fact("near", "plate"), iter(range(9))

    def said() -> Reply:
        answer: Answer = vlm.ask(Observation(look=next(looks), time=0.0), [question])[0]
        return answer.reply

    actions = (task.action(name, arguments) for name, *arguments in task.reachable_actions)
    action = next(
        each
        for each in actions
        if task.applicable(task.init, each) and question.atom in task.apply(task.init, each)
    )
    assert said() is Reply.NO
    assert simulation.execute(action).succeeded
    assert said() is Reply.NO
    kept = simulation.snapshot()
    simulation.execute(action)  # done already
    assert said() is Reply.YES
    simulation.restore(kept)
    assert said() is Reply.NO


def test_without_a_memory_of_before_there_is_none_that_is_late(task: Task) -> None:
    with pytest.raises(PluginError, match=r"no earlier\(\)"):
        made("flawed:late", truth=SceneTruth(), task=task)
    assert made("flawed:useless", truth=OlderTruth(), task=task).name == "flawed:useless"


@pytest.mark.parametrize(
    "spec",
    [
        "flawed",
        "flawed:missread:0.1",
        "flawed:misread",
        "flawed:misread:1.5",
        "flawed:misread:0.1:0.9:often",
        "flawed:misread:0.1:same",
        "flawed:misread:0.1:0.9:same:x",
        "flawed:biased",
        "flawed:biased:on:0.9",
        "flawed:late:0.8:1",
        "flawed:useless:x",
    ],
)
def test_a_wrong_specification_says_what_to_write(spec: str, task: Task) -> None:
    with pytest.raises(TpvqaError, match="flawed:misread:SHARE"):
        made(spec, truth=SceneTruth(), task=task)


def test_an_unknown_predicate_is_named_with_the_nearest(task: Task) -> None:
    with pytest.raises(UnknownNameError, match="Did you mean 'on'"):
        made("flawed:biased:onn:0.9:0.5", truth=SceneTruth(), task=task)


def test_what_it_is_told_may_come_from_a_strangers_log() -> None:
    assert is_plain(Kind.VLM, "flawed:biased:on:0.9:0.5")
