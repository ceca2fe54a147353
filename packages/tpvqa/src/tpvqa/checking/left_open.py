"""Facts that the problem states although one of `(oneof …)` holds, and never both do."""

from collections.abc import Iterator

from tpvqa.checking.finding import Finding, Severity, named
from tpvqa.pddl import Atom, Task
from tpvqa.pddl.worker.blocks import blocks
from tpvqa.pddl.worker.lisp import Block, read_block


def of_left_open(task: Task) -> Iterator[Finding]:
    """What is stated beside facts of which exactly one holds, where all of them are in a mutex
    group by what is stated alone: with both the group is none, and a robot in two places.

    Raises:
        PlannerError: The worker could not ground it.
    """
    if not task.oneof:
        return
    stated = task.init - task.left_open
    groups = [group.atoms for group in task.with_init(stated).mutex_groups]
    for choice in task.oneof:
        against = sorted(atom.pddl() for g in groups if choice <= g for atom in g & stated)
        if against:
            facts = " ".join(sorted(atom.pddl() for atom in choice))
            yield Finding(
                "stated-and-open",
                Severity.WARNING,
                f"{against[0]} is stated beside (oneof {facts}), which lets one of these hold as "
                "well; by the actions no two of them ever hold together",
                f"Leave out {against[0]}, or name it within (oneof …) as well.",
                named(task.problem_path),
                _line(task, choice),
            )


def _line(task: Task, choice: frozenset[Atom]) -> int | None:
    """Where such a choice stands."""
    facts = sorted(atom.pddl() for atom in choice)
    for block in blocks(read_block(task.problem_text)):
        parts = [f"({' '.join(map(str, part))})" for part in block if isinstance(part, Block)]
        if block[:1] == ["oneof"] and sorted(parts) == facts:
            return block.line
    return None
