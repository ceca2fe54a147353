"""What is said beforehand of how the world is at first, besides what the problem says."""

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from tpvqa.errors import PDDLError, PriorsError
from tpvqa.pddl import Atom, Task
from tpvqa.pddl.pattern import Pattern
from tpvqa.yaml_places import Place, read_yaml

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
    """

    facts: tuple[tuple[Pattern, float], ...] = ()
    elsewhere: float | None = None
    nothing_known: bool = False

    def stated(self, atoms: Collection[Atom], task: Task) -> dict[Atom, float]:
        """The probabilities of those of some facts that a form fits."""
        found: dict[Atom, float] = {}
        for pattern, probability in self.facts:
            for atom in atoms:
                if pattern.match(atom, {}, task) is not None:
                    found[atom] = probability
        return found

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
        PriorsError: It is missing or broken, or does not fit the task; with file and line.
    """
    root = None if path is None else read_yaml(Path(path), PriorsError)
    facts: list[tuple[Pattern, float]] = []
    elsewhere, nothing_known = None, start == "unknown"
    for name, key, value in root.entries() if root is not None else ():
        if name == NOTHING_KNOWN:
            nothing_known |= value.truth()
        elif name == ELSEWHERE:
            elsewhere = value.share()
            if elsewhere >= 1:
                raise value.wrong("expected less than 1: the problem says where things are")
        elif name.startswith("("):
            facts.append((_pattern(key, name, task), value.share()))
        else:
            raise key.wrong(
                f"{name!r} is not known here. Known: {ELSEWHERE}, {NOTHING_KNOWN}, and facts such "
                "as '(in ?thing fridge): 0.1'."
            )
    return Priors(tuple(facts), elsewhere, nothing_known)


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
