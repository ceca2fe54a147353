"""Errors that last: how answers to one question in one scene hang together."""

import json
from collections.abc import Sequence
from dataclasses import replace
from operator import eq

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.doubles import made
from tests.vlm.scene_truth import OlderTruth, SceneTruth
from tpvqa.errors import PluginError
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom, Task, load_task
from tpvqa.questions import FactQuestion, Way
from tpvqa.vlm import VLM, Reply
from tpvqa.vlm.making import as_logged, in_full
from tpvqa.vlm.oracle import Oracle
from tpvqa.vlm.recorded.answers import models, recordings
from tpvqa.vlm.recorded.lasting import lasting

QUESTIONS = [
    FactQuestion(f"Is it near {n}?", Way.PRECONDITION, Atom("near", (str(n),))) for n in range(4000)
]


def look(number: int, view: str = "") -> Observation:
    frames = {view: Frame("0", view, b"")} if view else {}
    return Observation(look=number, time=float(number), frames=frames)


def yeses(vlm: VLM, number: int, view: str = "") -> list[bool]:
    return [each.reply is Reply.YES for each in vlm.ask(look(number, view), QUESTIONS)]


def correlation(one: Sequence[bool], other: Sequence[bool], rate: float) -> float:
    products = [(a - rate) * (b - rate) for a, b in zip(one, other, strict=True)]
    return sum(products) / len(products) / (rate * (1 - rate))


@pytest.mark.parametrize("share", [0.0, 0.5, 0.74, 1.0])
def test_two_answers_in_one_scene_correlate_by_the_square_of_the_share(share: float) -> None:
    vlm = made(f"oracle:0.8:0:{share}", truth=SceneTruth(), seed=3)
    first, second = yeses(vlm, 0), yeses(vlm, 1)
    # Four standard errors of 4,000 pairs.
    assert correlation(first, second, 0.2) == pytest.approx(share**2, abs=0.07)
    for found in (first, second):
        assert sum(found) / len(found) == pytest.approx(0.2, abs=0.026)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_what_lasts_is_in_another_wording_the_same_as_often_as_is_said(share: float) -> None:
    vlm = made(f"oracle:0.8:0:1:words:{share:g}", truth=SceneTruth(), seed=3)
    others = [replace(each, text=f"{each.text}!", wording=1, first=each.text) for each in QUESTIONS]
    first = yeses(vlm, 0)
    other = [each.reply is Reply.YES for each in vlm.ask(look(1), others)]
    assert correlation(first, other, 0.2) == pytest.approx(share, abs=0.07)
    assert yeses(made("oracle:0.8:0:1", truth=SceneTruth(), seed=3), 0) == first


@pytest.mark.parametrize("spec", ["flawed:misread:0.3:1", "recorded:gemma-3-12b"])
def test_other_noise_models_are_told_how_far_wordings_err_alike(task: Task, spec: str) -> None:
    atoms = sorted(task.atoms())
    first = [FactQuestion(str(each), Way.EFFECT, each) for each in atoms]
    others = [replace(each, text=f"{each.text}!", wording=1, first=each.text) for each in first]
    same = {}
    for share in ("0", "1"):
        vlm = made(f"{spec}:words:{share}", truth=SceneTruth(), task=task, seed=3)
        told = [[a.reply for a in vlm.ask(look(n), each)] for n, each in enumerate((first, others))]
        same[share] = sum(map(eq, *told)) / len(atoms)
    assert same["0"] + 0.1 < same["1"]


@pytest.mark.parametrize("said", ["oracle:0.8:words:2", "oracle:0.8:words:", "recorded:x:words:a"])
def test_a_share_that_is_none_is_an_error(task: Task, said: str) -> None:
    with pytest.raises(PluginError, match="behind 'words:'"):
        made(said, truth=SceneTruth(), task=task)


@pytest.mark.parametrize("what", ["state", "view", "truth", "episode"])
def test_another_scene_is_drawn_by_itself(what: str) -> None:
    truth = SceneTruth()
    vlm = made("oracle:0.8:0:1", truth=truth, seed=3)
    first = yeses(vlm, 0, "front")
    if what == "state":
        truth.name = "second"
    if what == "truth":
        truth.true = {each.atom for each in QUESTIONS}
    if what == "episode":
        vlm = made("oracle:0.8:0:1", truth=truth, seed=3, episode=1)
    second = yeses(vlm, 1, "back" if what == "view" else "front")
    if what == "truth":
        first, second = [not yes for yes in first], second
        assert correlation(first, second, 0.8) == pytest.approx(0, abs=0.07)
    else:
        assert correlation(first, second, 0.2) == pytest.approx(0, abs=0.07)


def test_back_in_a_scene_the_answers_are_those_of_before() -> None:
    truth = SceneTruth()
    vlm = made("oracle:0.6:0:1", truth=truth)
    first = yeses(vlm, 0)
    truth.name = "second"
    assert yeses(vlm, 1) != first
    truth.name = "first"
    assert yeses(vlm, 2) == first


@given(st.floats(0, 1), st.floats(0, 1), st.integers(0, 4))
def test_a_restored_model_goes_on_as_the_unbroken_one(rho: float, share: float, cut: int) -> None:
    asked = QUESTIONS[:6]

    def run(cuts: set[int]) -> list[list[Reply]]:
        truth, rows = SceneTruth(), []
        vlm = Oracle(truth, accuracy=0.6, rho=rho, persistent=share, seed=1)
        for number, scene in enumerate("abaab"):
            truth.name = scene
            if number in cuts:
                kept = json.loads(json.dumps(vlm.snapshot()))
                vlm = Oracle(truth, accuracy=0.6, rho=rho, persistent=share, seed=1)
                vlm.restore(kept)
            rows.append([each.reply for each in vlm.ask(look(number), asked)])
        return rows

    assert run({cut}) == run(set())


def test_p_yes_is_its_accuracy_also_where_errors_last() -> None:
    vlm = made("oracle:0.8:0:0.74", truth=SceneTruth())
    for answer in vlm.ask(look(0), QUESTIONS[:50]):
        assert answer.p_yes == pytest.approx(0.8 if answer.reply is Reply.YES else 0.2)


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task("serve_breakfast")


@pytest.mark.parametrize("model", ["gemma-3-12b", "llava-onevision-7b"])
def test_recorded_errors_last_as_the_record_shows(model: str, task: Task) -> None:
    truth = SceneTruth()
    vlm = made(f"recorded:{model}", truth=truth, task=task, seed=2)
    told = recordings(model, "igibson").of("precondition", "reachable", truth=False)
    rate = sum(each.count for each in told if each.yes) / sum(each.count for each in told)
    first, second = yeses(vlm, 0), yeses(vlm, 1)
    truth.name = "second"
    third = yeses(vlm, 2)
    shares = lasting(model, "igibson")
    assert correlation(first, second, rate) == pytest.approx(shares.scene**2, abs=0.1)
    elsewhere = (shares.scene * shares.trial) ** 2
    assert correlation(second, third, rate) == pytest.approx(elsewhere, abs=0.1)
    for found in (first, second, third):
        assert sum(found) / len(found) == pytest.approx(rate, abs=0.035)


def test_every_recorded_model_has_shares_within_their_intervals() -> None:
    for model, environments in models().items():
        for environment in environments:
            found = lasting(model, environment)
            assert 0 < found.scene_interval[0] <= found.scene <= found.scene_interval[1] <= 1
            assert 0 < found.trial_interval[0] <= found.trial <= found.trial_interval[1] <= 1


def test_fresh_recorded_errors_need_no_scenes(task: Task) -> None:
    fresh = made("recorded:gemma-3-12b:1:fresh", truth=OlderTruth(), task=task)
    assert fresh.name == "recorded:gemma-3-12b:1:fresh"
    assert fresh.ask(look(0), QUESTIONS[:1])[0].reply in (Reply.YES, Reply.NO)


@pytest.mark.parametrize("spec", ["recorded:gemma-3-12b", "oracle:0.8:0:0.5"])
def test_a_world_that_tells_no_scenes_apart_is_refused(spec: str, task: Task) -> None:
    with pytest.raises(PluginError, match=r"has no scene\(\).*or choose"):
        made(spec, truth=OlderTruth(), task=task)


def test_specifications_are_logged_in_full_and_older_logs_mean_fresh_errors() -> None:
    assert in_full("recorded:gemma-3-12b:1") == "recorded:gemma-3-12b:1:lasting"
    assert as_logged("recorded:gemma-3-12b:1") == "recorded:gemma-3-12b:1:fresh"
    for spec in ("recorded:gemma-3-12b:fresh", "recorded:gemma-3-12b:lasting", "oracle:0.8"):
        assert in_full(spec) == as_logged(spec) == spec
    assert as_logged("nowhere:installed") == "nowhere:installed"
