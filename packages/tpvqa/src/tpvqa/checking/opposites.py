"""Opposites that are both asked about: of each object exactly one of two predicates holds."""

from collections.abc import Iterator

from tpvqa.checking.finding import Finding, Severity, named
from tpvqa.checking.places import line_of_predicate
from tpvqa.checking.possible import atoms_of
from tpvqa.pddl import Atom, Literal, Task, literals
from tpvqa.questions import QuestionBook


def of_opposites(task: Task, book: QuestionBook, into: str) -> Iterator[Finding]:
    """Predicates that say the same, with a line that leaves one of their questions out.

    Args:
        task: The task.
        book: Its questions.
        into: The questions file's name.
    """
    wanted = {literal.atom.predicate for literal in literals(task.goal)}
    for pair in _pairs(task):
        kept, left = sorted(pair, key=lambda name: (name not in wanted, name))
        if not _both_asked(task, book, kept, left):
            continue
        because = f"it is asked as {kept}, its opposite"
        if left in wanted:
            because += "; so is what the goal wants of it"
        yield Finding(
            "opposites",
            Severity.NOTE,
            f"exactly one of {' and '.join(pair)} holds, and both are asked about",
            "One question may do; a second one in other words may err otherwise, so that both are "
            "well where errors last.",
            named(task.domain_path),
            line_of_predicate(task, left),
            (
                "never_asked:",
                f'  - fact: "({" ".join((left, *task.predicate_variables[left]))})"',
                f"    because: {because}",
            ),
            into,
        )


def _pairs(task: Task) -> list[tuple[str, str]]:
    """Predicates of which exactly one holds, whatever they are said of."""
    found = dict[tuple[str, str], None]()
    for group in task.mutex_groups:
        if group.exactly_one and len(group.atoms) == 2:
            one, other = sorted(group.atoms)
            if one.predicate != other.predicate and one.arguments == other.arguments:
                found[one.predicate, other.predicate] = None
    return [pair for pair in found if _always(task, *pair)]


def _always(task: Task, one: str, other: str) -> bool:
    said_of = {atom.arguments for name in (one, other) for atom in atoms_of(task, name)}
    return all(
        any(
            group.exactly_one and group.atoms == {Atom(one, each), Atom(other, each)}
            for group in task.groups_of(Atom(one, each))
        )
        for each in said_of
    )


def _both_asked(task: Task, book: QuestionBook, kept: str, left: str) -> bool:
    """Whether what one question tells is told by the other wherever that is asked."""
    asked = [atom for atom in atoms_of(task, left) if book.asked(Literal(atom))]
    return bool(asked) and all(book.asked(Literal(Atom(kept, a.arguments))) for a in asked)
