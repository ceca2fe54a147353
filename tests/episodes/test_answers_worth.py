"""Which calibration a trial went by, and what more of it would save."""

import re
from pathlib import Path

import pytest
from rich.console import Console

from tests.doubles import configured
from tpvqa.belief import AnswerRates, Calibration, Group
from tpvqa.bench.stage import stage
from tpvqa.cli.terminal import EpisodeView
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.episodes.answers_worth import AnswersWorth, calibration_used
from tpvqa.episodes.report import render_report
from tpvqa.events import Ended, Event, Started
from tpvqa.events.events import Decided

CONFIG = configured(
    task="clean_dishes", world="symbolic", vlm="oracle:0.9", monitor="belief", episode=1
)
KNOWN = Calibration.default("oracle:0.9").model_copy(
    update={
        "whole": Group(rates=AnswerRates(0.9, 0.1, 0.0, 0.0), rows=1200),
        "groups": (),
        "ways": (),
        "rows": 1200,
        "by_hand": 60,
        "repeat_same_view": 0.0,
    }
)


def events_of(config: TrialConfig, known: Calibration | None = None) -> list[Event]:
    writer = MemoryWriter()
    assert config.task.name is not None
    with stage(config.task.name).trial(config, calibration=known) as trial:
        trial.run(writer)
    return writer.events


def started(events: list[Event]) -> Started:
    first = events[0]
    assert isinstance(first, Started)
    return first


def saves(events: list[Event]) -> str:
    worth = AnswersWorth()
    for event in events:
        worth.take(event)
    return worth.more_would_save()


def asked_and_less(told: str) -> tuple[int, int]:
    """How many questions were asked, and how many less there would be."""
    less = re.search(r"about (\d+) of the (\d+) questions less", told)
    assert less is not None, told
    return int(less[2]), int(less[1])


def questions(events: list[Event]) -> int:
    ended = events[-1]
    assert isinstance(ended, Ended)
    return ended.questions


def test_the_default_is_named_and_what_it_costs() -> None:
    asked = less = then = 0
    for episode in (1, 2, 3, 6):  # whose answers are enough to tell
        events = events_of(CONFIG.but(episode=episode))
        assert calibration_used(started(events)) == "default: nothing was known of this VLM"
        told = saves(events)
        agreed = re.match(r"(\d+) of (\d+) answers agreed .* action, ([01]\.\d\d), and", told)
        assert agreed is not None
        assert abs(float(agreed[3]) - 0.9) < 0.15
        assert float(agreed[3]) == round(int(agreed[1]) / int(agreed[2]), 2)
        told_asked, told_less = asked_and_less(told)
        assert told_asked == questions(events)
        asked, less = asked + told_asked, less + told_less
        then += questions(events_of(CONFIG.but(episode=episode), KNOWN))
    assert 0 < less < asked
    assert then < asked  # as it says


def test_a_calibration_is_named_with_what_it_was_learnt_from() -> None:
    events = events_of(CONFIG, KNOWN)
    used = calibration_used(started(events))
    assert used == f"of oracle:0.9, learnt from 1,200 answers, by 60 labels ({KNOWN.fingerprint})"
    inferred = KNOWN.model_copy(update={"by_hand": 0, "inferred": 900, "vlm": "oracle:0.8"})
    used = calibration_used(started(events_of(CONFIG, inferred)))
    assert "of which nobody said what was right" in used
    assert used.endswith("; oracle:0.9 answered")


def test_answers_that_are_worse_than_believed_are_told() -> None:
    good = Group(rates=AnswerRates(0.95, 0.05, 0.0, 0.0))
    known = KNOWN.model_copy(update={"whole": good})
    told = [saves(events_of(CONFIG.but(vlm="oracle:0.7", episode=n), known)) for n in range(5)]
    assert any("labels would say how far not to trust them" in each for each in told)
    for each in told:  # seldom they happen to agree as often as believed
        share = re.search(r"action, ([01]\.\d\d), and", each)
        assert ("questions less" in each) <= (share is not None and float(share[1]) > 0.9)


def test_nothing_is_saved_by_answers_that_mostly_settled_nothing() -> None:
    """Ended in doubt: the few answers that were counted as right are those that were believed."""
    events = events_of(CONFIG.but(episode=6))
    half = len(events) // 2
    events = [*events[:half], *map(_in_doubt, events[half:])]
    told = saves(events)
    counted = re.match(r"(\d+) of (\d+) answers agreed .* and (\d+) more were about", told)
    assert counted is not None, told
    assert int(counted[2]) < int(counted[3])
    assert "questions less" not in told
    assert "cannot be told" in told


def _in_doubt(event: Event) -> Event:
    """An event that leaves in doubt what it believes."""
    if not isinstance(event, Decided):
        return event
    return event.model_copy(update={"belief": dict.fromkeys(event.belief, 0.6)})


@pytest.mark.parametrize("monitor", ["tpvqa", "tp"])
def test_a_monitor_that_weighs_nothing_says_nothing(monitor: str) -> None:
    events = events_of(CONFIG.but(monitor=monitor))
    assert calibration_used(started(events)) == ""
    assert saves(events) == ""


def test_a_strangers_calibration_ends_nothing() -> None:
    events = events_of(CONFIG)
    events[0] = started(events).model_copy(
        update={"calibration": {"version": 9}, "experience": {"trust": "all"}}
    )
    assert calibration_used(started(events)) == "of another version of tpvqa"
    assert saves(events) == ""
    assert "of another version of tpvqa" in render_report(events, Path())


def test_report_and_terminal_say_it() -> None:
    events = events_of(CONFIG)
    page = " ".join(render_report(events, Path()).split())
    assert "calibration default: nothing was known of this VLM." in page
    assert "questions less" in page
    console = Console(record=True, width=300, file=open("/dev/null", "w"))  # noqa: SIM115
    view = EpisodeView(console, live=False)
    for event in events:
        view(event)
    text = console.export_text()
    assert "calibration default: nothing was known of this VLM" in text
    assert "questions less" in text
