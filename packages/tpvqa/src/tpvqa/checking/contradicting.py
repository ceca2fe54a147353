"""Effects of an action that add and delete the same fact in the same case.

They are looked for in the text: the translator keeps the fact that is added, and says nothing.
"""

from collections.abc import Iterator
from typing import NamedTuple

from tpvqa.checking.finding import Finding, Severity, named
from tpvqa.pddl import Task
from tpvqa.pddl.worker.blocks import sections
from tpvqa.pddl.worker.lisp import Block, line_of, read_block

_NUMERIC = ("increase", "decrease", "assign", "scale-up", "scale-down")


class _Effect(NamedTuple):
    """A fact that is added or deleted.

    Attributes:
        fact: The fact, as text.
        case: When: the blocks around it, as text.
        line: Where it stands.
    """

    fact: str
    case: tuple[str, ...]
    line: int | None


def of_effects(task: Task) -> Iterator[Finding]:
    """Actions that add and delete a fact at once. In PDDL the add wins."""
    domain = read_block(task.domain_text)
    for kind in (":action", ":durative-action"):
        for action in sections(domain, kind):
            added, deleted = list[_Effect](), list[_Effect]()
            _sort(_effect(action), (), added, deleted)
            wins = {(each.fact, each.case) for each in added}
            for each in deleted:
                if (each.fact, each.case) in wins:
                    yield Finding(
                        "effects-contradict",
                        Severity.WARNING,
                        f"the action {action[1]} adds and deletes {each.fact} in the same case: "
                        "the fact will hold, as what is added wins in PDDL",
                        "Leave out one of the two effects.",
                        named(task.domain_path),
                        each.line,
                    )


def _effect(action: Block) -> object:
    at = action.index(":effect") if ":effect" in action else len(action)
    return action[at + 1] if at + 1 < len(action) else None


def _sort(
    effect: object, case: tuple[str, ...], added: list[_Effect], deleted: list[_Effect]
) -> None:
    if not isinstance(effect, Block) or not effect or effect[0] in _NUMERIC:
        return
    match effect:
        case ["and", *parts]:
            for part in parts:
                _sort(part, case, added, deleted)
        case ["when" | "forall", _, inner] | ["at", "start" | "end", Block() as inner]:
            _sort(inner, (*case, _text(effect[:2])), added, deleted)
        case ["not", fact]:
            deleted.append(_Effect(_text(fact), case, line_of(effect)))
        case _:
            added.append(_Effect(_text(effect), case, line_of(effect)))


def _text(part: object) -> str:
    return f"({' '.join(map(_text, part))})" if isinstance(part, list) else str(part)
