"""What loop and skill server say to each other: JSON in `std_msgs/String`, on two topics.

The loop speaks on PREFIX/command, the server on PREFIX/status. Of a message that is not understood
nothing is believed and nothing is done.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tpvqa.observation import SensedFact
from tpvqa.pddl import Atom
from tpvqa.worlds import Report

VERSION = 1
COMMAND, STATUS, STOP, JOINTS, TRUTH = "command", "status", "stop", "joints", "truth"
BEAT = 0.2
"""Seconds between two beats of a loop, and of a server."""
LONGEST = 100_000
"""Letters of a message that are read."""

Said = Mapping[str, Any]


def write(say: str, **values: Any) -> str:
    """A message as text."""
    return json.dumps({"v": VERSION, "say": say, **values}, allow_nan=False)


def read(text: str) -> Said | None:
    """A message of text; None where it is none of ours."""
    if len(text) > LONGEST:
        return None
    try:
        said = json.loads(text)
    except (ValueError, RecursionError):
        return None
    if not isinstance(said, dict) or said.get("v") != VERSION:
        return None
    return said if isinstance(said.get("say"), str) else None


def text_of(said: Said, key: str) -> str | None:
    """A text of a message; None where there is none."""
    value = said.get(key)
    return value if isinstance(value, str) else None


def number_of(said: Said, key: str) -> float | None:
    """A finite number of a message; None where there is none."""
    value = said.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if math.isfinite(value) else None


@dataclass(frozen=True, slots=True)
class Result:
    """How a skill ended.

    Attributes:
        report: As of `worlds.Report`.
        seconds: How long it took.
        message: For people.
        facts: What the robot sensed then.
        ended: When, by the clock of the pictures' stamps.
    """

    report: Report
    seconds: float
    message: str
    facts: Sequence[SensedFact]
    ended: float


def result_of(said: Said) -> Result | None:
    """The result that a message tells; None where it is malformed: then nothing is known."""
    seconds, ended = number_of(said, "seconds"), number_of(said, "ended")
    message, facts = text_of(said, "message"), facts_of(said.get("facts"))
    if seconds is None or ended is None or message is None or facts is None:
        return None
    try:
        report = Report(str(said.get("report")))
    except ValueError:
        return None
    return Result(report, seconds, message, facts, ended)


def facts_of(given: object) -> tuple[SensedFact, ...] | None:
    """Facts as `[["(hand_empty)", 0.98], …]`; None where they are malformed."""
    if not isinstance(given, list):
        return None
    facts = []
    for each in given:
        if not isinstance(each, list) or len(each) != 2 or not isinstance(each[0], str):
            return None
        probability = number_of({"p": each[1]}, "p")
        if probability is None or not 0 <= probability <= 1 or not each[0].strip("() "):
            return None
        try:
            facts.append(SensedFact(Atom.parse(each[0]), probability))
        except ValueError:
            return None
    return tuple(facts)


def written(facts: Iterable[SensedFact]) -> list[list[Any]]:
    """Facts as `facts_of` reads them."""
    return [[fact.atom.pddl(), float(fact.probability)] for fact in facts]
