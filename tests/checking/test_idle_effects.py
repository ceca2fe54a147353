"""Conditional effects that never come about: told once an action, with what they lack."""

from tests.checking.test_check import Files, files
from tpvqa.checking import Severity

__all__ = ["files"]


def test_an_effect_whose_condition_never_holds_is_told(files: Files) -> None:
    files.change("domain.pddl", "    (pressed ?p - part)", "    (hot)\n    (pressed ?p - part)")
    effect = "(and (pressed ?p) (when (hot) (and (not (held ?p)) (free))))"
    files.change("domain.pddl", ":effect (pressed ?p)", f":effect {effect}")
    (found,) = (each for each in files.found() if each.kind == "effect-never")
    assert found.severity is Severity.WARNING
    assert (
        "press never comes about in this problem: it needs (hot), which never holds" in found.says
    )
    assert found.line == files.line("domain.pddl", "(:action press")
    files.change("problem.pddl", "(free)", "(free) (hot)")
    assert "effect-never" not in {each.kind for each in files.found()}
