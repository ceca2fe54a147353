"""A log whose events do not hang together is told with the event, wherever it is read."""

import json
from codecs import BOM_UTF8
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.doubles import configured
from tpvqa.assembly import Trial
from tpvqa.episodes import EpisodeWriter, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.errors import EpisodeError

Line = dict[str, Any]
Change = Callable[[list[Line]], object]


@pytest.fixture(scope="module")
def lines(tmp_path_factory: pytest.TempPathFactory) -> list[bytes]:
    """started, plan made, observed, asked, answered, decided, acting, acted, …"""
    folder = tmp_path_factory.mktemp("episode")
    config = configured(task="build_tower", world="symbolic", vlm="oracle:0.9", monitor="tpvqa")
    with Trial(config) as trial:
        writer = EpisodeWriter(folder, durable=False)
        trial.run(writer)
        writer.close()
    return (folder / LOG).read_bytes().splitlines()


def at(lines: list[Line], kind: str) -> int:
    return next(place for place, line in enumerate(lines) if line["kind"] == kind)


def without(kind: str) -> Change:
    def change(lines: list[Line]) -> None:
        del lines[at(lines, kind)]
        for place, line in enumerate(lines):
            line["number"] = place

    return change


def with_(kind: str, **values: Any) -> Change:
    return lambda lines: lines[at(lines, kind)].update(values)


def swapped(lines: list[Line]) -> None:
    one, other = at(lines, "asked"), at(lines, "decided")
    lines[one], lines[other] = lines[other], lines[one]
    for place, line in enumerate(lines):
        line["number"] = place


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (without("asked"), "it answers what was not asked"),
        (with_("observed", facts=[{"atom": "()", "probability": 1}]), "is no fact"),
        (with_("acted", facts=[{"atom": "", "probability": 1}]), "is no fact"),
        (without("answered"), "stands where the answers are expected"),
        (without("acting"), "stands where none is executed"),
        (without("acted"), "stands where an action is executed"),
        (without("plan made"), "no step 0 in the plan"),
        (without("observed"), "look 0, which was never taken"),
        (without("started"), "a log begins with one 'started'"),
        (swapped, "no step|another action|not asked|answers are expected"),
        (lambda lines: lines.pop(3), "it is number 4, and 3 is expected"),
        (lambda lines: lines.append({**lines[-1], "number": len(lines)}), "follows the end"),
        (with_("answered", answers=[]), "0 answers to"),
        (with_("decided", step=99), "no step 99"),
        (with_("decided", action="(fly)"), "is another action"),
        (with_("decided", onto=-1), "no step -1"),
        (with_("decided", belief={"(": 0.5}), "is no fact"),
        (with_("acting", attempt=-1), "attempt is number -1"),
        (with_("observed", look=7), "look 7, and 0 is expected"),
        (with_("asked", look=7), "look 7, which was never taken"),
        (with_("acted", truth={"undone": "()"}), "is no fact"),
        (with_("acted", truth=[]), "acted.truth"),
        (with_("started", config={}), None),
        (lambda lines: lines[at(lines, "asked")]["questions"][0].update(action="(a)"), None),
        (lambda lines: lines[at(lines, "asked")]["questions"][0].pop("atom"), "a fact or about an"),
        (with_("started", config={"seed": "many"}), "config.seed"),
        (with_("started", config=None), "config"),
        (with_("started", initial=["()"]), "is no fact"),
        (with_("started", schema=9), "schema 9"),
        (with_("started", schema=9), "It was edited, or written by a version under development"),
        (with_("started", schema=9, version="9.9"), "tpvqa 9.9 reads it"),
        (with_("answered", answers=[{"reply": "perhaps"}]), "reply"),
        (with_("acted", seconds="1"), "seconds"),
        (with_("acted", unknown=1), "unknown"),
    ],
)
def test_events_that_do_not_hang_together_are_told_with_their_place(
    lines: list[bytes], tmp_path: Path, change: Change, says: str | None
) -> None:
    read = [json.loads(line) for line in lines]
    change(read)
    (tmp_path / LOG).write_text("".join(f"{json.dumps(line)}\n" for line in read))
    if says is None:
        assert read_episode(tmp_path)
        return
    with pytest.raises(EpisodeError, match=rf"episode\.jsonl.*({says})"):
        read_episode(tmp_path)


@pytest.mark.parametrize(
    ("value", "says"),
    [
        ("1" * 10**6, "has 1000000 digits"),
        ("NaN", "NaN is no number"),
        ("-Infinity", "is no number"),
        ("1e999", "no number that can be counted with"),
        ("[" * 10**5 + "]" * 10**5, "nested too deeply"),
        ('{"a": 1, "a": 2}', "'a' is given twice"),
        ('"\\ud800"', "hex escape"),
        ("01", "damaged"),
        ('"' + "a" * 17 * 2**20 + '"', "longer than"),
    ],
    ids=lambda value: value[:12],
)
def test_json_that_readers_could_take_differently_is_refused(
    lines: list[bytes], tmp_path: Path, value: str, says: str
) -> None:
    first = json.loads(lines[0])
    first["config"]["options"] = {"x": "HERE"}
    data = json.dumps(first).replace('"HERE"', value).encode()
    (tmp_path / LOG).write_bytes(data + b"\n" + lines[1] + b"\n")
    with pytest.raises(EpisodeError, match=rf"episode\.jsonl:1: .*{says}"):
        read_episode(tmp_path)


def test_what_is_damaged_is_told_with_what_can_be_done(lines: list[bytes], tmp_path: Path) -> None:
    (tmp_path / LOG).write_bytes(b"".join(line + b"\n" for line in [*lines[:9], b"{}", *lines[9:]]))
    with pytest.raises(EpisodeError, match=r"episode\.jsonl:10: .*keep only the 9 lines before"):
        read_episode(tmp_path)
    (tmp_path / LOG).write_bytes(b"".join(line + b"\n" for line in lines[:9]))
    assert len(read_episode(tmp_path)) == 9
    (tmp_path / LOG).write_bytes(BOM_UTF8 + lines[0] + b"\n")
    with pytest.raises(EpisodeError, match=r"jsonl:1: .*byte order mark; save the file as UTF-8"):
        read_episode(tmp_path)
