"""What is said of things, as a question and as its negation."""

from dataclasses import dataclass

from tpvqa.drafting.facts_tables import SAME
from tpvqa.drafting.forms import third
from tpvqa.drafting.things import Things, plural


@dataclass(frozen=True, slots=True)
class Noun:
    """A subject or an object of a sentence, as a template has it.

    Attributes:
        said: "the {x}", "{x.the}", "the robot".
        objects: What it can stand for; empty for a fixed noun.
        parameter: The placeholder's name; empty for a fixed noun.
        plural: Whether a fixed noun is several things.
    """

    said: str
    objects: tuple[str, ...] = ()
    parameter: str = ""
    plural: bool = False


ROBOT = Noun("the robot")


def part(name: str, of: str = "") -> Noun:
    """What a name says there is, of something: the lid of the {x}, the gloves."""
    return Noun(f"the {name}{of and ' of '}{of}", plural=plural(name.split()[-1]))


@dataclass(frozen=True, slots=True)
class Clause:
    """ "is · the {x} · on the {y}": what holds exactly if the fact does.

    Attributes:
        auxiliary: is, has, does or can.
        subject: Of whom.
        rest: What.
    """

    auxiliary: str
    subject: Noun
    rest: str


class Phrases:
    """Nouns and clauses about the things of a task, with the attributes that they need.

    Args:
        things: The things.
        plain: Whether to do without attributes: for single lines in a file that has others.

    Attributes:
        wanted: The attributes that what was said so far relies on: the, place, Is, Has, Does.
        places: The objects whose place was spoken of.
    """

    def __init__(self, things: Things, *, plain: bool = False):
        self.things = things
        self._plain = plain
        self.wanted: set[str] = set()
        self.places: set[str] = set()

    def noun(self, parameter: str, objects: tuple[str, ...]) -> Noun:
        """A parameter as a noun: with "the", unless its objects are called crate 2."""
        articles = {self.things.label(obj).article for obj in objects} or {True}
        if self._plain or articles == {True}:
            return Noun(f"the {{{parameter}}}", objects, parameter)
        self.wanted.add("the")
        return Noun(f"{{{parameter}.the}}", objects, parameter)

    def placed(self, noun: Noun, written: str | None = None) -> str:
        """A noun as where something is: "on the {x}", or "{x.place}" where that differs.

        Args:
            noun: The place.
            written: The preposition that the domain's author used.
        """
        ways = {self.things.place_of(obj) for obj in noun.objects} or {"at"}
        if self._plain and len(ways) > 1:
            return f"{written or 'at'} {noun.said}"
        known = all(map(self.things.holds_things, noun.objects)) and bool(noun.objects)
        if written == "on" and known and ways == {"in"}:
            return f"on {noun.said}"
        if written in ("on", "at") and known and noun.parameter and len(ways) > 1:
            self.wanted.add("place")
            self.places.update(noun.objects)
            return f"{{{noun.parameter}.place}}"
        if written is None and len(ways) > 1 and noun.parameter:
            self.wanted.add("place")
            self.places.update(noun.objects)
            return f"{{{noun.parameter}.place}}"
        if written in (None, "at") and len(ways) == 1:
            return f"{ways.pop()} {noun.said}"
        return f"{written or 'at'} {noun.said}"

    def stood_at(self, noun: Noun, written: str) -> str:
        """A noun as where somebody stands: at the bench, not on it. Arguments as of `placed`."""
        upon = any(self.things.place_of(obj) == "on" for obj in noun.objects)
        return f"at {noun.said}" if upon and written == "at" else self.placed(noun, written)

    def another(self, place: str) -> str:
        """The same place in other words: "inside the {x}" for "in the {x}"."""
        preposition, _, rest = place.partition(" ")
        return f"{SAME[preposition]} {rest}" if preposition in SAME and rest else place

    def question(self, clause: Clause) -> str:
        """ "Is the {x} on the {y}?" """
        word = clause.auxiliary.capitalize()
        if clause.subject.plural:
            word = {"Is": "Are", "Has": "Have", "Does": "Do"}.get(word, word)
        elif (
            not self._plain
            and word != "Can"
            and any(self.things.label(obj).plural for obj in clause.subject.objects)
        ):
            self.wanted.add(word)
            word = f"{{{clause.subject.parameter}.{word}}}"
        return " ".join(f"{word} {clause.subject.said} {clause.rest}".split()) + "?"

    def affirmation(self, clause: Clause) -> str | None:
        """ "Is it true that the {x} is on the {y}?"; None where it may be of several things."""
        if any(self.things.label(obj).plural for obj in clause.subject.objects):
            return None
        word, rest = clause.auxiliary, clause.rest.replace(" any ", " some ")
        subject = clause.subject.said.replace("anything", "something")
        if clause.subject.plural:
            word = {"is": "are", "has": "have", "does": ""}.get(word, word)
        elif word == "does":
            verb, _, tail = rest.partition(" ")
            word, rest = third(verb), tail
        return " ".join(f"Is it true that {subject} {word} {rest}?".split()).replace(" ?", "?")

    def denial(self, clause: Clause) -> str:
        """ "Is it true that the {x} is not on the {y}?" """
        word = clause.auxiliary
        if clause.subject.plural:
            word = {"is": "are", "has": "have", "does": "do"}.get(word, word)
        return " ".join(f"Is it true that {clause.subject.said} {word} not {clause.rest}?".split())


def unknown(words: list[str], nouns: list[Noun]) -> Clause:
    """Where a name does not tell what it means: something to be rewritten."""
    said = " ".join(words)
    if not nouns:
        return Clause("is", Noun("it"), f"true that {said}")
    rest = " and ".join(noun.said for noun in nouns[1:])
    return Clause("is", nouns[0], f"{said}{f' with {rest}' if rest else ''}")
