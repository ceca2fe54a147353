"""Ways of one action in the same words: told where both may be possible at once."""

import pytest

from tests.checking.test_check import Files, files
from tpvqa.checking import Severity

__all__ = ["files"]


@pytest.mark.parametrize(("needed", "told"), [("(empty ?t)", True), ("(lies ?p ?t)", False)])
def test_words_that_leave_out_with_what_an_action_is_done_are_told(
    files: Files, needed: str, told: bool
) -> None:
    """Either tray may be the empty one, and both may be; but a part is in one tray at a time."""
    extra = f"""
  (:action stamp
    :parameters (?p - part ?t - tray)
    :precondition {needed}
    :effect (pressed ?p)))
"""
    files.change("domain.pddl", "    :effect (pressed ?p)))\n", "    :effect (pressed ?p))" + extra)
    files.change("questions.yaml", "actions:", 'actions:\n  stamp: {say: "stamp the {p}"}')
    found = [each for each in files.found() if each.kind == "same-words-for-actions"]
    assert [each.severity for each in found] == [Severity.NOTE] * told
    assert all("'stamp the cap'" in each.says for each in found)


@pytest.mark.parametrize(("needed", "told"), [("(empty ?o)", 1), ("(lies ?p ?o)", 0)])
def test_ways_that_are_never_possible_are_not_compared(
    files: Files, needed: str, told: int
) -> None:
    """No part lies in two trays."""
    extra = f"""
  (:action stamp
    :parameters (?p - part ?t ?o - tray)
    :precondition (and (lies ?p ?t) {needed} (not (= ?t ?o)))
    :effect (and (pressed ?p) (empty ?o))))
"""
    files.change("domain.pddl", "    :effect (pressed ?p)))\n", "    :effect (pressed ?p))" + extra)
    files.change("questions.yaml", "actions:", 'actions:\n  stamp: {say: "stamp the {p}"}')
    found = [each for each in files.found() if each.kind == "same-words-for-actions"]
    assert len(found) == told
