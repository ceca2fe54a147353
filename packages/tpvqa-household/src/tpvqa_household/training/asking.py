"""What can be asked in a household, and the words for it."""

from collections.abc import Iterable
from dataclasses import dataclass

from tpvqa.pddl import Action, Atom, Task, load_task
from tpvqa_household.embedded.lexicon import Lexicon
from tpvqa_household.training.subjects import Subject, catalogue
from tpvqa_household.training.wordings import wordings


@dataclass(frozen=True)
class Asking:
    """Everything that can be asked.

    Attributes:
        actions: The ground actions.
        subjects: What questions can be about.
        lexicon: The words of all wordings.
    """

    actions: tuple[Action, ...]
    subjects: tuple[Subject, ...]
    lexicon: Lexicon

    @classmethod
    def about(cls, task: Task | str) -> "Asking":
        """All that can be asked about a task's actions and what they read and change."""
        actions = tuple((load_task(task) if isinstance(task, str) else task).ground_actions())
        subjects = catalogue(sorted(_atoms(actions)), actions)
        texts = [w.text for subject in subjects for w in wordings(subject)]
        return cls(actions, subjects, Lexicon.of(texts))


def _atoms(actions: Iterable[Action]) -> set[Atom]:
    from tpvqa.pddl import literals

    found = set()
    for action in actions:
        found |= {literal.atom for literal in literals(action.precondition)}
        found |= {effect.literal.atom for effect in action.effects}
    return {atom for atom in found if not (atom.predicate == "on" and _fixed(atom, found))}


def _fixed(atom: Atom, atoms: set[Atom]) -> bool:
    """Whether an on-atom is about a thing that nothing can ever move."""
    return not any(a.predicate == "in_hand" and a.arguments[0] == atom.arguments[0] for a in atoms)
