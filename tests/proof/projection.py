"""What counts of an episode's log, in a form that does not change when the log's format does.

Read as plain JSON, so that only this file has to know how an event is written. Times, snapshots,
versions, paths and settings are left out, and so is what only tells the same in words.
"""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

LOG = "episode.jsonl"
TOLD = ("because", "belief")
"""Entries that say why; all others say what was seen, asked, answered, decided and done."""

Entry = list[Any]
"""What it is, and then what counts of it: words, numbers, and lists of them."""
Record = Mapping[str, Any]


def projection(folder: Path) -> list[Entry]:
    """One entry or more for each event that counts, in order.

    Args:
        folder: Of an episode.

    Raises:
        ValueError: An event is of a kind that is not known here.
    """
    found: list[Entry] = []
    for line in (folder / LOG).read_text(encoding="utf-8").splitlines():
        event = json.loads(line)
        kind = event["kind"]
        if kind not in _ENTRIES:
            raise ValueError(f"{folder / LOG}: what counts of {kind!r}? Say so in {__file__}")
        found += _ENTRIES[kind](event)
    return found


def _nothing(_event: Record) -> list[Entry]:
    return []


def _plan(event: Record) -> list[Entry]:
    result = event["result"]
    actions = [_pddl(action) for action in event["plan"]] if result == "plan" else result
    return [["considered" if event.get("considered") else "plan", actions]]


def _look(event: Record) -> list[Entry]:
    """Rendered pictures have no source: what they show depends on the machine that draws them."""
    frames = [[each["view"], each.get("source", "")] for each in event.get("frames", ())]
    return [["look", event.get("view"), frames]]


def _asked(event: Record) -> list[Entry]:
    questions = [
        [each["text"], each["way"], each.get("expected", True)] for each in event["questions"]
    ]
    return [["asked", "person" if event.get("person") else "VLM", questions]]


def _answered(event: Record) -> list[Entry]:
    answers = [[each["reply"], _rounded(each.get("p_yes"), 4)] for each in event["answers"]]
    return [["answered", answers]]


def _believed(event: Record) -> list[Entry]:
    return [["believed", event.get("added", []), event.get("removed", [])]]


def _decided(event: Record) -> list[Entry]:
    names = ("when", "step", "action", "decision", "onto")
    belief = {atom: _rounded(p, 3) for atom, p in sorted(event.get("belief", {}).items())}
    return [
        ["decided", *map(event.get, names)],
        ["because", event["reason"]],
        *([["belief", belief]] if belief else []),
    ]


def _acting(event: Record) -> list[Entry]:
    action = event["action"]
    return [["act", _pddl(action), action["said"], event["step"], event["attempt"]]]


def _acted(event: Record) -> list[Entry]:
    truth = event.get("truth")
    if truth is None:
        return [["acted", event["report"], None]]
    changed = truth.get("added", []), truth.get("removed", [])
    return [["acted", event["report"], [not truth.get("failure"), truth.get("undone"), *changed]]]


def _ended(event: Record) -> list[Entry]:
    names = ("because", "completed", "believed_goal", "goal_holds")
    counters = ("actions", "questions", "looks", "repeats", "replans")
    return [["ended", *map(event.get, names), {name: event[name] for name in counters}]]


_ENTRIES: Mapping[str, Callable[[Record], list[Entry]]] = {
    "started": _nothing,
    "plan made": _plan,
    "observed": _look,
    "asked": _asked,
    "answered": _answered,
    "believed": _believed,
    "decided": _decided,
    "acting": _acting,
    "acted": _acted,
    "ended": _ended,
}


def _pddl(action: Record) -> str:
    return f"({' '.join([action['name'], *action['arguments']])})"


def _rounded(number: float | None, digits: int) -> float | None:
    return None if number is None else round(number, digits)
