"""Whatever a plug-in returns, a trial says so, and writes nothing that cannot be read again."""

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import EpisodeWriter, read_episode
from tpvqa.errors import PluginError
from tpvqa.observation import Observation, SensedFact
from tpvqa.pddl import Atom
from tpvqa.questions import Question
from tpvqa.vlm import Answer, Reply
from tpvqa.worlds import Execution, Report

ON = Atom("on", ("apple", "table"))


def _answer(question: Question) -> Answer:
    return Answer(question, Reply.YES if question.expected else Reply.NO)


class _VLM:
    name = "strange"

    def __init__(self, ask: Callable[[Sequence[Question]], Any]):
        self._ask = ask

    def ask(self, observation: Observation, questions: Sequence[Question]) -> Any:
        return self._ask(questions)


def _trial(vlm: _VLM | None = None) -> Trial:
    config = TrialConfig().but(
        task={"name": "eat_apple"},
        world={"spec": "symbolic"},
        vlm={"spec": "oracle:1"},
        monitor={"spec": "tpvqa"},
    )
    return Trial(config, vlm=vlm)


def _fails(trial: Trial, folder: Path) -> None:
    writer = EpisodeWriter(folder, durable=False)
    with trial, pytest.raises(PluginError):
        trial.run(writer, folder=folder)
    writer.close()
    assert read_episode(folder)  # what was written can be read


@pytest.mark.parametrize(
    "ask",
    [
        lambda questions: sys.exit(0),  # 0 would say that the goal is reached
        lambda questions: [replace(_answer(each), seconds=math.inf) for each in questions],
        lambda questions: [replace(_answer(each), text="\ud800") for each in questions],
        lambda questions: [replace(_answer(each), reply="yes") for each in questions],  # type: ignore[arg-type]
        lambda questions: [
            Answer(replace(each, text="Is it late?"), Reply.YES) for each in questions
        ],
    ],
    ids=["exit", "endless", "no text", "no reply", "another question"],
)
def test_a_vlm_that_answers_strangely(ask: Any, tmp_path: Path) -> None:
    _fails(_trial(_VLM(ask)), tmp_path)


@pytest.mark.parametrize(
    ("method", "result"),
    [
        ("execute", Execution(Report.DONE, math.nan)),
        ("execute", Execution(Report.DONE, -5.0)),
        ("execute", Execution(Report.DONE, "5")),  # type: ignore[arg-type]
        ("execute", Execution(Report.DONE, 0.0, "\ud800")),
        ("execute", Execution("done", 0.0)),  # type: ignore[arg-type]
        ("execute", Execution(Report.DONE, 0.0, facts=(SensedFact(ON, math.nan),))),
        ("execute", Execution(Report.DONE, 0.0, facts=(SensedFact(ON, 1.5),))),
        ("execute", Execution(Report.DONE, 0.0, facts=(SensedFact(ON, "1"),))),  # type: ignore[arg-type]
        ("execute", Execution(Report.DONE, 0.0, facts=(SensedFact("(on apple table)"),))),  # type: ignore[arg-type]
        ("execute", Execution(Report.DONE, 0.0, facts=(ON,))),  # type: ignore[arg-type]
        ("execute", Execution(Report.DONE, 0.0, facts=None)),  # type: ignore[arg-type]
        ("observe", Observation(facts="(on apple table)")),  # type: ignore[arg-type]
        ("observe", Observation(facts=[SensedFact(Atom("on", ("aple", "table")))])),
        ("observe", Observation(time=math.inf, frames={})),
        ("observe", Observation(frames={}, detail={"a": object()})),
    ],
)
def test_a_world_that_says_strange_things(method: str, result: object, tmp_path: Path) -> None:
    trial = _trial()
    setattr(trial.world, method, lambda *given, **named: result)
    _fails(trial, tmp_path)


@pytest.mark.parametrize("told", [None, ["onn"], [3]])
def test_a_world_that_senses_what_is_no_predicate(told: Any, monkeypatch: Any) -> None:
    monkeypatch.setattr("tpvqa.worlds.symbolic.SymbolicWorld.senses", lambda world: told)
    with pytest.raises(PluginError, match=r"SymbolicWorld\.senses (has to )?return"):
        _trial()


@pytest.mark.parametrize("views", ["front", [1], [""], None])
def test_views_that_are_no_list_of_names(views: Any, monkeypatch: Any) -> None:
    monkeypatch.setattr("tpvqa.worlds.symbolic.SymbolicWorld.views", lambda world: views)
    with pytest.raises(PluginError, match=r"SymbolicWorld\.views has to return"):
        _trial()


def test_a_fact_that_no_task_has_is_named_with_the_nearest(tmp_path: Path) -> None:
    trial = _trial()
    facts = [SensedFact(Atom("on", ("aple", "table")), 0.9)]
    setattr(trial.world, "execute", lambda *given, **named: Execution(Report.DONE, 0.0, "", facts))  # noqa: B010
    said = r"SymbolicWorld\.execute returned .*no object 'aple'\. Did you mean 'apple'\?"
    with trial, pytest.raises(PluginError, match=said):
        trial.run(EpisodeWriter(tmp_path, durable=False))


def _without_verdict(step: object) -> Any:
    return None
    yield


@pytest.mark.parametrize("check", [lambda step: None, _without_verdict])
def test_a_monitor_that_decides_nothing(check: Any, tmp_path: Path) -> None:
    trial = _trial()
    trial.monitor.before = check  # type: ignore[method-assign]
    _fails(trial, tmp_path)
