"""What the terminal shows of a belief, and of plans that are only considered."""

import sys
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from tests.episodes.believing import (
    FIND,
    PICK,
    all_followed,
    believing,
    decided,
    plan,
    started,
    without_belief,
)
from tpvqa.cli import main
from tpvqa.cli.terminal import EpisodeView
from tpvqa.episodes import EpisodeWriter
from tpvqa.events import Event
from tpvqa.monitors import Decision


def shown(events: list[Event], *, terminal: bool = False) -> list[str]:
    """The lines of an episode, without colours."""
    console = Console(
        file=StringIO(), force_terminal=terminal, color_system=None, width=120, legacy_windows=False
    )
    view = EpisodeView(console, live=False)
    for event in events:
        view(event)
    assert isinstance(console.file, StringIO)
    return console.file.getvalue().splitlines()


def test_outside_a_terminal_a_belief_is_one_line_of_numbers_that_are_new() -> None:
    lines = [line.strip() for line in shown(believing())]
    assert [line for line in lines if line.startswith("belief:")] == [
        "belief: bread on the plate .30",
        "belief: bread in the image >.99 (▲1.00)",
        "belief: bread in a robot's hand (left) .60 (▲.60)",
        "belief: bread in a robot's hand (left) .97 (▲.37)",
    ]


def test_in_a_terminal_each_fact_has_a_bar() -> None:
    bars = [line for line in shown(believing(), terminal=True) if "▕" in line]
    assert bars[2:] == [
        "    bread in a robot's hand (left) ▕████▊   ▏  .60 ▲.60",
        "    bread in a robot's hand (left) ▕███████▊▏  .97 ▲.37",
    ]


def test_without_a_belief_nothing_is_said_of_one() -> None:
    lines = shown(without_belief(believing()), terminal=True)
    assert not any("▕" in line or "belief:" in line for line in lines)
    assert any("repeat" in line for line in lines)


def test_a_plan_that_is_only_considered_is_neither_shown_nor_followed() -> None:
    text = "\n".join(shown(believing()))
    assert "new plan" not in text
    assert "find the TV" not in text
    assert "2. pick up the bread (attempt 2)" in text
    assert "\n".join(shown(all_followed(believing()))).count("new plan find the TV") == 2


def test_the_step_is_named_where_a_monitor_goes_on_at_another_one() -> None:
    events: list[Event] = [
        started(),
        plan(FIND, PICK),
        decided("after", 1, Decision.GO_ON, near=0.2),
        decided("before", 0, Decision.GO_ON),
    ]
    assert [line for line in shown(events) if line[0].isdigit()] == [
        "2. pick up the bread",
        "1. find the bread",
    ]


def test_an_episode_is_shown_again_with_its_belief(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    writer = EpisodeWriter(tmp_path / "here")
    for event in believing():
        writer.append(event)
    writer.close()
    monkeypatch.setattr(sys, "argv", ["tpvqa", "show", str(tmp_path / "here")])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 0
    assert capsys.readouterr().out.splitlines() == shown(believing())
