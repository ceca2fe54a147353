"""Whether the questions fit the domain: facts without words, words in vain, words that coincide."""

import re
import unicodedata
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

from tpvqa.checking.finding import Finding, Severity, named
from tpvqa.checking.places import (
    line_of_action,
    line_of_entry,
    line_of_object,
    line_of_predicate,
)
from tpvqa.checking.possible import atoms_of
from tpvqa.drafting import LOOK, Words
from tpvqa.pddl import Action, Atom, Literal, Task
from tpvqa.pddl.conditions import literals, required_of
from tpvqa.pddl.whole import seen_predicates, whole_actions
from tpvqa.questions import QuestionBook
from tpvqa.questions.wordings import Wordings

_TWICE = re.compile(r"\b(\w+) \1\b", re.IGNORECASE)
_LOOKED_AT = 20_000
"""Ground actions, and atoms, that are put into words to be compared."""


def without_words(task: Task, given: Wordings, drafted: Words, into: str) -> Iterator[Finding]:
    """Facts and actions for which the questions file has no words, with words to paste.

    Args:
        task: The task.
        given: The questions file.
        drafted: A draft of one: what is proposed.
        into: The questions file's name.
    """
    never = {each.fact.predicate for each in given.never_asked if each.everywhere}
    for name in seen_predicates(task):
        if name not in given.predicates and name not in never:
            said = drafted.questions[name]
            yield Finding(
                "fact-without-question",
                Severity.WARNING,
                f"no question is given for the predicate {name}",
                "Give it one, or list it under never_asked where no camera shows it.",
                named(task.domain_path),
                line_of_predicate(task, name),
                ("predicates:", f'  {_key(name)}: "{said}"{drafted.unsure.get(name, "")}'),
                into,
            )
    for schema in whole_actions(task):
        if schema.name not in given.say:
            say, done = drafted.actions[schema.name]
            look = drafted.unsure.get(schema.name, "")
            yield Finding(
                "action-without-words",
                Severity.NOTE,
                f"the action {schema.name} has no words",
                "Give it some: questions about whole actions, and reports, are made of them.",
                named(task.domain_path),
                line_of_action(task, schema.name),
                ("actions:", f'  {_key(schema.name)}: {{say: "{say}", done: "{done}"}}{look}'),
                into,
            )


def _key(name: str) -> str:
    return f'"{name}"' if name in ("on", "off", "yes", "no", "true", "false", "null") else name


def doubled(given: Wordings, file: Path | None) -> Iterator[Finding]:
    """Questions that say a word twice in a row, as hasty edits and names do: "in the the air"."""
    for name, first in given.predicates.items():
        for template in (first, *given.others.get(name, ())):
            text = "".join(map(str, template.parts))
            if found := _TWICE.search(text):
                yield Finding(
                    "doubled-word",
                    Severity.WARNING,
                    f"the question about {name} says {found[0]!r}: {text!r}",
                    "Take one out.",
                    named(file),
                    line_of_entry(file, "predicates", name),
                )


def still_marked(file: Path | None) -> Iterator[Finding]:
    """Lines that the draft marked for a person to look at, and that are as they were drafted.

    Args:
        file: The questions file, which has been read before: it is none that is too large.
    """
    if file is None:
        return
    for number, line in enumerate(file.read_text("utf-8", errors="replace").splitlines(), 1):
        if f"# {LOOK}:" in line:
            yield Finding(
                "still-to-look-at",
                Severity.NOTE,
                f"{line.strip().partition(':')[0]} is marked {LOOK}: its words are a guess",
                "Say it better where it is wrong, and take the mark out.",
                str(file),
                number,
            )


def in_vain(task: Task, given: Wordings, file: Path | None) -> Iterator[Finding]:
    """Questions that are never asked, and patterns that match nothing."""
    doubted = {each.fact.predicate for each in given.in_doubt}
    for name in given.predicates:
        if name not in task.fluents | task.derived | doubted and not any(
            atom.predicate == name for atom in task.left_open
        ):
            yield Finding(
                "question-in-vain",
                Severity.WARNING,
                f"the question about {name} is never asked, as no action changes it",
                "Leave it out, or name the fact under in_doubt where it may be wrong.",
                named(file),
                line_of_entry(file, "predicates", name),
            )
    known = task.reachable_atoms | task.init
    for section, patterns in (
        ("never_asked", given.never_asked),
        ("in_doubt", given.in_doubt),
        ("still_shown", given.still_shown),
    ):
        for pattern in patterns:
            fact = pattern.fact
            idle = fact.predicate not in task.fluents | task.derived  # its reason may be that
            if pattern.actions or (idle and section == "never_asked"):
                continue
            if any(fact.match(a, {}, task) is not None for a in known):
                continue
            yield Finding(
                "pattern-matches-nothing",
                Severity.WARNING,
                f"{fact} under {section} matches no fact that can hold in this problem",
                "Mend it; if other problems of the domain need it, leave it.",
                named(file),
                line_of_entry(file, section, fact.predicate),
            )
    for each in given.notices:
        place, _, says = each.partition(": ")
        where, _, line = place.rpartition(":")
        number = int(line) if line.isdigit() else None
        yield Finding("unknown-object", Severity.NOTE, says, "", where or None, number)


def _as_read(text: str) -> str:
    """A text as people tell it from others: without what shows nothing, in one form of letters."""
    if not text.isascii():
        seen = "".join(each for each in text if unicodedata.category(each) != "Cf")
        text = unicodedata.normalize("NFKC", seen)
    return " ".join(text.casefold().split())


def alike(task: Task, book: QuestionBook, file: Path | None) -> Iterator[Finding]:
    """Objects, facts and actions that are called the same."""
    yield from _same_names(task, book)
    yield from _same_questions(task, book, file)
    yield from _same_in_other_words(task, book, file)
    yield from _contradictions(task, book, file)
    yield from _same_actions(task, book, file)


def _same_names(task: Task, book: QuestionBook) -> Iterator[Finding]:
    names: dict[str, str] = {}
    for obj in task.objects:
        other = names.setdefault(_as_read(book.name(obj)), obj)
        if other != obj:
            yield Finding(
                "same-name",
                Severity.WARNING,
                f"{other} and {obj} are both called {book.name(obj)!r}",
                "Name them under objects by what tells them apart in a picture.",
                named(task.problem_path),
                line_of_object(task, obj),
            )


def _same_questions(task: Task, book: QuestionBook, file: Path | None) -> Iterator[Finding]:
    texts: dict[str, Atom] = {}
    told: set[frozenset[str]] = set()
    changing = task.fluents | task.derived
    atoms = (a for name in task.predicates if name in changing for a in atoms_of(task, name))
    for atom in islice(atoms, _LOOKED_AT):
        if not book.asked(Literal(atom)):
            continue
        first = texts.setdefault(_as_read(book.fact(Literal(atom)).text), atom)
        pair = frozenset((first.predicate, atom.predicate))
        if first == atom or pair in told:
            continue
        told.add(pair)
        text = book.fact(Literal(atom)).text
        one = first.predicate == atom.predicate
        yield Finding(
            "same-question",
            Severity.NOTE if one else Severity.WARNING,
            f"{first.pddl()} and {atom.pddl()} are asked in the same words: {text!r}",
            "Yes is then right if either holds; that is well where no picture tells them apart, "
            "else name in the question what does."
            if one
            else "Ask about them in words that differ.",
            named(file),
            line_of_entry(file, "predicates", atom.predicate),
        )


def _same_in_other_words(task: Task, book: QuestionBook, file: Path | None) -> Iterator[Finding]:
    """Other wordings in which two facts are asked the same that their first wordings tell apart."""
    several = [name for name in task.predicates if book.wordings(name) > 1]
    texts = {
        _as_read(book.fact(Literal(atom)).text): atom
        for name in task.fluents | task.derived
        for atom in islice(atoms_of(task, name), _LOOKED_AT)
    }
    told: set[tuple[str, int]] = set()
    for name in several:
        for atom in islice(atoms_of(task, name), _LOOKED_AT):
            question = book.fact(Literal(atom))
            if not book.asked(Literal(atom)):
                continue
            for each in book.in_other_words(question):
                other = texts.setdefault(_as_read(each.text), atom)
                same = _as_read(book.fact(Literal(other)).text) == _as_read(question.text)
                if other == atom or same or (name, each.wording) in told:
                    continue
                told.add((name, each.wording))
                yield Finding(
                    "same-question",
                    Severity.WARNING,
                    f"wording {each.wording + 1} of {name} asks about {atom.pddl()} in words that "
                    f"ask about {other.pddl()}, too: {each.text!r}",
                    "Leave that wording out, or name in it what tells them apart.",
                    named(file),
                    line_of_entry(file, "predicates", name),
                )


def _contradictions(task: Task, book: QuestionBook, file: Path | None) -> Iterator[Finding]:
    told = set()
    for action in islice(task.ground_actions(), _LOOKED_AT):
        texts: dict[str, Literal] = {}
        for effect in action.effects:
            literal = effect.literal
            if not book.asked(literal, action):
                continue
            first = texts.setdefault(book.fact(literal).text, literal)
            if first.positive != literal.positive and first.atom != literal.atom:
                if action.name in told:
                    continue
                told.add(action.name)
                yield Finding(
                    "opposite-answers",
                    Severity.WARNING,
                    f"after {action.pddl()} {first} and {literal} are asked in the same words, and "
                    "expect opposite answers, so that neither is asked",
                    "Name in the question what tells them apart.",
                    named(file),
                    line_of_entry(file, "predicates", literal.atom.predicate),
                )


def _same_actions(task: Task, book: QuestionBook, file: Path | None) -> Iterator[Finding]:
    texts: dict[str, Action] = {}
    told: set[frozenset[str]] = set()
    for action in islice(task.ground_actions(), _LOOKED_AT):
        if _at_odds(task, action):
            continue
        first = texts.setdefault(_as_read(book.say(action)), action)
        pair = frozenset((first.name, action.name))
        one = len(pair) == 1
        if first is action or pair in told or (one and not _differ(task, first, action)):
            continue
        told.add(pair)
        yield Finding(
            "same-words-for-actions",
            Severity.NOTE if one else Severity.WARNING,
            f"{first.pddl()} and {action.pddl()} are said in the same words: {book.say(action)!r}",
            "Whole actions cannot be asked about apart then (possible, successful, did); name in "
            "`say` what differs, where that can be seen.",
            named(file),
            line_of_entry(file, "actions", action.name),
        )


def _at_odds(task: Task, action: Action) -> bool:
    """Whether an action needs facts that never hold together, such as one thing in two places."""
    needed = _needed(action)
    return any(len(needed & group.atoms) > 1 for atom in needed for group in task.groups_of(atom))


def _needed(action: Action) -> frozenset[Atom]:
    """What an action needs to be true."""
    return frozenset(each.atom for each in required_of(action.precondition) if each.positive)


def _differ(task: Task, one: Action, other: Action) -> bool:
    """Whether two ways of an action bring about other facts, or may both be possible and need
    other facts: not to pick up a thing from where it is, and from where it is not."""
    if _brings(one) != _brings(other):
        return True
    if frozenset(literals(one.precondition)) == frozenset(literals(other.precondition)):
        return False
    mine, its = _needed(one), _needed(other)
    return not any(
        another in group.atoms
        for atom in mine - its
        for group in task.groups_of(atom)
        for another in its - mine
    )


def _brings(action: Action) -> frozenset[Atom]:
    """What an action makes true."""
    return frozenset(e.literal.atom for e in action.effects if e.literal.positive)
