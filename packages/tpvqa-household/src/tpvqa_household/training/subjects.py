"""What the network is asked about: facts in words, and actions in each way of asking."""

from collections.abc import Sequence
from dataclasses import dataclass

from tpvqa.pddl import Action, Atom
from tpvqa.questions.question import ActionWay, Way

SAID = {
    "find": (0,),
    "pick_up": (0,),
    "place": (0, 1),
    "open": (0,),
    "wash": (0,),
    "turn_on": (0,),
    "cut_in_half": (0,),
}
"""Which arguments of an action its words name; hands and whence it comes are left unsaid."""

ACTION_WAYS: tuple[ActionWay, ...] = (Way.POSSIBLE, Way.SUCCESSFUL, Way.DID)
_SILENT = {"in_hand": 1}


@dataclass(frozen=True, slots=True, order=True)
class Subject:
    """What a question is about, as far as its words tell.

    Attributes:
        form: "fact" for facts, whichever way they are asked in, else a way of asking about actions.
        name: The predicate or action.
        arguments: The arguments that the words name: for in_hand the item, not the hand.
    """

    form: str
    name: str
    arguments: tuple[str, ...]

    def __str__(self) -> str:
        inner = f"{self.name}({', '.join(self.arguments)})"
        return inner if self.form == "fact" else f"{self.form} {inner}"


def subject_of(atom: Atom) -> Subject:
    """The subject of a question about a fact."""
    return Subject("fact", atom.predicate, atom.arguments[: _SILENT.get(atom.predicate)])


def action_subject(way: Way, action: Action) -> Subject:
    """The subject of a question about an action."""
    said = SAID.get(action.name, range(len(action.arguments)))
    return Subject(way.value, action.name, tuple(action.arguments[i] for i in said))


def catalogue(atoms: Sequence[Atom], actions: Sequence[Action]) -> tuple[Subject, ...]:
    """All subjects of the given facts and actions, in a fixed order."""
    facts = {subject_of(atom) for atom in atoms if atom.predicate != "free"}
    acts = {action_subject(way, action) for action in actions for way in ACTION_WAYS}
    return (*sorted(facts), *sorted(acts))
