"""Trials come out as they did when they were recorded: in all that was decided, asked and done."""

import json
from collections.abc import Sequence
from difflib import unified_diff
from functools import cache
from pathlib import Path

import pytest

from tests.proof.projection import TOLD, Entry
from tests.proof.record import recorded
from tests.proof.running import outcome
from tests.proof.specs import SPECS, Spec

SHOWN = 24
"""Lines of a difference that are shown."""


@cache
def _recorded() -> dict[str, list[Entry]]:
    return recorded()


@pytest.mark.parametrize(
    "spec",
    [
        pytest.param(spec, id=spec.name, marks=[pytest.mark.rendering] * spec.rendered)
        for spec in SPECS
    ],
)
def test_a_trial_comes_out_as_before(spec: Spec, tmp_path: Path) -> None:
    there, here = _recorded()[spec.name], outcome(spec, tmp_path / "trial")
    told = difference(there, here)
    assert not told, f"{spec.name}:\n{told}"


def test_the_record_is_of_these_trials() -> None:
    assert set(_recorded()) == {spec.name for spec in SPECS}


def difference(there: Sequence[Entry], here: Sequence[Entry]) -> str:
    """The first lines in which two outcomes differ; empty where they do not.

    What was decided and done goes before the reasons for it.
    """
    found = _lines(_bare(there), _bare(here))
    head = []
    if not found:
        found = _lines(there, here)
        head = ["What was decided and done is the same; what was told of it is not."]
    if not found:
        return ""
    more = [f"… {len(found) - SHOWN} more lines"] * (len(found) > SHOWN)
    return "\n".join([*head, *found[:SHOWN], *more])


def _bare(entries: Sequence[Entry]) -> list[Entry]:
    return [each for each in entries if each[0] not in TOLD]


def _lines(there: Sequence[Entry], here: Sequence[Entry]) -> list[str]:
    before, now = (
        [json.dumps(each, ensure_ascii=False) for each in entries] for entries in (there, here)
    )
    return list(unified_diff(before, now, "recorded", "now", n=1, lineterm=""))
