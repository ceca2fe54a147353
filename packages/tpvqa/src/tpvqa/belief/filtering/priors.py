"""What is said beforehand of how the world is at first, besides what the problem says."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from math import fsum
from pathlib import Path

from tpvqa.errors import PDDLError, PriorsError, shown, suggestion
from tpvqa.pddl import Atom, Task
from tpvqa.pddl.pattern import Pattern
from tpvqa.yaml_places import Place, read_yaml

ROUNDED = 1e-6
"""What probabilities that add up to 1 may be beyond it."""
_NAMED = 4
"""Facts that a message names."""
ELSEWHERE = "elsewhere"
NOTHING_KNOWN = "nothing_known"


@dataclass(frozen=True, slots=True)
class Priors:
    """How probable facts are at first.

    Attributes:
        facts: Forms of facts with their probabilities; of several that fit the last one counts.
        elsewhere: Probability that a thing is not where the problem says; None for the usual
            small doubt (`doubts.ELSEWHERE`), while simulated worlds are as the problem says.
        nothing_known: Whether nothing is known but the objects and what no action changes.
        lines: Where the forms stand in their file.
        empty: Whether there is a file, and it says nothing.
    """

    facts: tuple[tuple[Pattern, float], ...] = ()
    elsewhere: float | None = None
    nothing_known: bool = False
    lines: tuple[int, ...] = field(default=(), compare=False)
    empty: bool = field(default=False, compare=False)

    def stated(self, atoms: Collection[Atom], task: Task) -> dict[Atom, float]:
        """The probabilities of those of some facts that a form fits."""
        return {atom: self.facts[nth][1] for atom, nth in self.deciding(atoms, task).items()}

    def deciding(self, atoms: Collection[Atom], task: Task) -> dict[Atom, int]:
        """Which form counts for those of some facts that one fits."""
        found: dict[Atom, int] = {}
        for nth, (pattern, _) in enumerate(self.facts):
            for atom in atoms:
                if pattern.match(atom, {}, task) is not None:
                    found[atom] = nth
        return found

    def groups(self, task: Task) -> Iterator[dict[Atom, int]]:
        """For facts of which one holds at most: which form counts for each that one fits."""
        for group in (*(group.atoms for group in task.mutex_groups), *task.oneof):
            yield self.deciding(sorted(atom for atom in group if task.fits(atom)), task)

    @property
    def opens(self) -> bool:
        """Whether some fact is less sure than the problem says."""
        return bool(self.facts) or self.nothing_known


def load_priors(task: Task, path: Path | str | None, start: str = "known") -> Priors:
    """Read a file of priors.

    Args:
        task: The task that it is about.
        path: The file; None for none.
        start: "unknown" where nothing is known, whatever the file says.

    Example:
        elsewhere: 0.02
        (in ?thing fridge): 0.1

    Raises:
        PriorsError: It is missing or broken, does not fit the task, or contradicts itself; with
            file and line.
    """
    root = None if path is None else read_yaml(Path(path), PriorsError)
    facts: list[tuple[Pattern, float]] = []
    keys: list[Place] = []
    elsewhere, nothing_known = None, start == "unknown"
    for name, key, value in root.entries() if root is not None else ():
        if name == NOTHING_KNOWN:
            nothing_known |= value.truth()
        elif name == ELSEWHERE:
            elsewhere = value.share()
            if elsewhere >= 1:
                raise value.wrong("expected less than 1: the problem says where things are")
        elif name.startswith("("):
            pattern = _pattern(key, name, task)
            if any(_same(pattern, other) for other, _ in facts):
                raise key.wrong(f"{pattern} is given twice; leave one of the two out")
            facts.append((pattern, value.share()))
            keys.append(key)
        else:
            raise key.wrong(
                f"{shown(name)} is not known here{suggestion(name, (ELSEWHERE, NOTHING_KNOWN))} "
                f"Known: {ELSEWHERE}, {NOTHING_KNOWN}, and facts such as '(in ?thing fridge): 0.1'."
            )
    empty = path is not None and (root is None or not root.entries())
    lines = tuple(key.line for key in keys)
    found = Priors(tuple(facts), elsewhere, nothing_known, lines, empty)
    if facts:  # else the groups need not be worked out
        _check_sums(found, keys, task)
    return found


def _same(one: Pattern, other: Pattern) -> bool:
    """Whether two forms differ in the names of variables at most."""
    return _unnamed(one) == _unnamed(other)


def _unnamed(pattern: Pattern) -> tuple[object, ...]:
    variables = {term: nth for nth, term in reversed(list(enumerate(pattern.terms)))}
    named = (variables[each] if each.startswith("?") else each for each in pattern.terms)
    return (pattern.predicate, *named, *pattern.types)


def _check_sums(priors: Priors, keys: Sequence[Place], task: Task) -> None:
    """See that lines about facts of which one holds at most are not more probable together than 1.

    What one line says of several of them is shared out among them.

    Raises:
        PriorsError: They are.
    """
    for deciding in priors.groups(task):
        first = {nth: atom for atom, nth in reversed(deciding.items())}
        shares = {first[nth]: priors.facts[nth][1] for nth in sorted(first)}
        if fsum(shares.values()) <= 1 + ROUNDED:
            continue
        named = [f"{atom.pddl()} {share:g}" for atom, share in shares.items() if share]
        more = f" and {len(named) - _NAMED} more" if len(named) > _NAMED else ""
        raise keys[max(first)].wrong(
            f"at most one of {', '.join(named[:_NAMED])}{more} holds, and together that is "
            f"{fsum(shares.values()):g}; make them add up to 1 at most"
        )


def _pattern(key: Place, name: str, task: Task) -> Pattern:
    try:
        pattern = Pattern.parse(name, task)
    except PDDLError as error:
        raise key.wrong(error.message) from None
    if pattern.predicate in task.derived:
        raise key.wrong(f"{pattern} is derived, so it follows from other facts; name those")
    if pattern.predicate not in task.fluents:
        raise key.wrong(
            f"no action changes {pattern.predicate!r}, so it is as the problem says; write "
            "(unknown …) or (oneof …) into the problem's (:init …) where that is not known"
        )
    return pattern
