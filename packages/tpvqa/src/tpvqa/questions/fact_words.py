"""Facts in the words of a task's questions: "bread on the plate" for (on bread plate)."""

import re
from itertools import repeat

from tpvqa.errors import PDDLError
from tpvqa.pddl import Atom, Literal
from tpvqa.questions.book import QuestionBook

_ASKING = re.compile(r"^(?:Is|Are) (?:there )?(?:it true: )?(?:the |an? )?(?P<said>.+)\?$")
_BEEN = re.compile(r"^(?:Has|Have) (?:the |an? )?(?P<who>.+?) been (?P<what>.+)\?$")
_ASKED_OF = re.compile(r"^(?P<verb>Does|Do|Can|Has|Have) (?:the |an? )?(?P<said>.+)\?$")


class FactWords:
    """Says facts as they are asked about; as atoms where there are no words for them.

    Args:
        book: The questions of the task, if there are any.
    """

    def __init__(self, book: QuestionBook | None = None):
        self.book = book
        self._said: dict[Atom, str] = {}

    def say(self, fact: str) -> str:
        """A fact, or that it does not hold, given as PDDL, in words; as it is, where it is none of
        the task's."""
        if self.book is None:
            return fact
        if fact.startswith("(not "):
            return f"not {self.say(fact[len('(not ') : -1])}"
        atom = Atom.parse(fact)
        if atom not in self._said:
            try:
                self.book.task.check_atom(atom)
            except PDDLError:
                return fact
        return self.of(atom)

    def of(self, atom: Atom) -> str:
        """A fact of the task in words."""
        if self.book is None:
            return str(atom)
        if atom not in self._said:
            question = self.book.fact(Literal(atom))
            texts = [question.text, *(o.text for o in self.book.in_other_words(question))]
            said = next(filter(None, map(self._stated, texts, repeat(atom))), str(atom))
            # The words may leave out objects; then two facts would be called the same.
            unsaid = [
                self.book.name(argument)
                for place, argument in enumerate(atom.arguments)
                if any(other.arguments[place] != argument for other in question.alike)
            ]
            self._said[atom] = f"{said} ({', '.join(unsaid)})" if unsaid else said
        return self._said[atom]

    def _stated(self, text: str, atom: Atom) -> str | None:
        """What a question asks about; None where its subject cannot be told from the rest."""
        if asking := _ASKING.match(text):
            return asking["said"]
        if been := _BEEN.match(text):
            return f"{been['who']} {been['what']}"
        asked = _ASKED_OF.match(text)
        if asked is None or self.book is None:
            return None
        names = [self.book.name(each) for each in atom.arguments]
        for who in sorted((*names, "robot's hand", "robot", "hand"), key=len, reverse=True):
            if asked["said"].startswith(f"{who} "):
                verb, *rest = asked["said"].removeprefix(f"{who} ").split(" ")
                does = {"Does": _third(verb), "Do": verb}.get(asked["verb"])
                said = [does] if does else [asked["verb"].lower(), verb]
                return " ".join([who, *said, *rest])
        return None


def _third(verb: str) -> str:
    """A verb's third person."""
    if verb == "have":
        return "has"
    if verb.endswith("y") and verb[-2:-1] not in "aeiou":
        return f"{verb[:-1]}ies"
    return f"{verb}es" if verb.endswith(("s", "sh", "ch", "x", "z", "o")) else f"{verb}s"
