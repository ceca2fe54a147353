"""Predicates put into questions, by what their names are in English."""

from collections.abc import Iterator
from dataclasses import dataclass

from tpvqa.drafting import lexicon
from tpvqa.drafting.clauses import ROBOT, Clause, Noun, Phrases, part, unknown
from tpvqa.drafting.doubt import (
    either_of,
    is_done,
    is_misread,
    lacks_a_word,
    open_to_doubt,
    seldom_shown,
)
from tpvqa.drafting.facts_tables import PLAIN, ROADS, SAME
from tpvqa.drafting.forms import (
    Form,
    does,
    does_verb,
    ing,
    is_ing,
    is_there,
    participle,
    stands,
    verb_form,
)
from tpvqa.drafting.lexicon import ADJECTIVES, PREPOSITIONS
from tpvqa.drafting.named_places import in_hand, there
from tpvqa.drafting.of_nothing import of_nothing
from tpvqa.drafting.predicates import of_noun, of_verb, without_kind
from tpvqa.drafting.things import Things, plural, some
from tpvqa.questions.template import indefinite_article

_NEGATIONS = ("not", "no", "non")


@dataclass(frozen=True, slots=True)
class Said:
    """The wordings of a predicate.

    Attributes:
        wordings: Templates of questions that are answered yes exactly if the fact is true, the
            one to ask first.
        unsure: Whether the name does not tell what it means.
        opposite: The predicate that it denies, where the domain has it.
        unseen: Whether it is something that a picture seldom shows.
    """

    wordings: tuple[str, ...]
    unsure: bool = False
    opposite: str | None = None
    unseen: bool = False


class Facts:
    """Puts the predicates of a task into questions.

    Args:
        phrases: Says the task's things.
    """

    def __init__(self, phrases: Phrases):
        self._phrases = phrases
        self._things: Things = phrases.things
        self._task = phrases.things.task

    def said(self, predicate: str) -> Said:
        """The wordings of a predicate."""
        words = self._things.words(predicate)
        nouns = self._nouns(predicate)
        none = words[0] == "no" and len(nouns) == 1 and words[-1] in PREPOSITIONS and len(words) > 2
        denied = words[0] in _NEGATIONS and len(words) > 1 and not none
        lacks = words[0] == "no" and len(nouns) == 1 and self._is_thing(words[1:])
        meant = words[1:] if denied else words
        clauses = [c for c in self._clauses(meant, nouns, predicate) if not is_misread(c)]
        if lacks:
            clauses = [Clause("does", nouns[0], f"have {some(words[1:])}")]
        unsure = not clauses
        if unsure:
            clauses = [unknown(meant, nouns)]
        if self._may_end(predicate):  # what has been bolted may be loose again
            now = [c for c in clauses if not (c.auxiliary == "has" and c.rest.startswith("been "))]
            clauses = now or clauses
        say = self._phrases.denial if denied else self._phrases.question
        wordings = list(dict.fromkeys(map(say, clauses)))
        affirmed = self._phrases.affirmation(clauses[0])
        if len(wordings) == 1 and not denied and not unsure:
            of, rest = clauses[0].subject, clauses[0].rest
            again = Clause("does", of, f"look {rest}")
            if " " in rest:
                again = Clause("can", of, f"be found {rest}")
            wordings += [affirmed or say(again)] if affirmed or clauses[0].auxiliary == "is" else []
        missing = [n.said for n in nouns if f"{{{n.parameter}" not in wordings[0]]
        unsure = unsure or (bool(missing) and not self._leaves_out(nouns, wordings[0]))
        unsure = unsure or open_to_doubt(words, nouns, clauses[0])
        unsure = unsure or lacks_a_word(clauses[0], nouns, self._things)
        unsure = unsure or either_of(words, [self._named(noun) for noun in nouns])
        opposite = self._opposite(predicate) if denied else None
        return Said(tuple(wordings[:3]), unsure, opposite, seldom_shown(words))

    def _may_end(self, predicate: str) -> bool:
        """Whether an action makes facts of a predicate false."""
        effects = (e.literal for schema in self._task.schemas for e in schema.effects)
        return any(each.predicate == predicate and not each.positive for each in effects)

    def _is_thing(self, words: list[str]) -> bool:
        """Whether words are what the task calls things, as something may have them: cart, of
        no-cart."""
        return bool(words) and words[-1] in self._things.vocabulary | lexicon.PARTS

    def _leaves_out(self, nouns: list[Noun], wording: str) -> bool:
        """Whether a wording leaves out only what there is one of."""
        left = [n for n in nouns if f"{{{n.parameter}" not in wording]
        return all(len(noun.objects) == 1 for noun in left)

    def _nouns(self, predicate: str) -> list[Noun]:
        names = [v.lstrip("?") for v in self._task.predicate_variables[predicate]]
        return [
            self._phrases.noun(name, self._things.standing(predicate, at))
            for at, name in enumerate(names)
        ]

    def _opposite(self, predicate: str) -> str | None:
        plain = "".join(self._things.words(predicate)[1:])
        count = len(self._task.predicates[predicate])
        for other, kinds in self._task.predicates.items():
            if len(kinds) == count and "".join(self._things.words(other)) == plain:
                return other
        return None

    def _named(self, noun: Noun) -> frozenset[str]:
        """What a name may call an argument."""
        return self._things.nouns(noun.objects) | {noun.parameter}

    # Which kind of name it is

    def _clauses(self, words: list[str], nouns: list[Noun], predicate: str) -> Iterator[Clause]:
        if len(words) > 1 and (words[0] in ("is", "are", "was", "being") or stands(words)):
            words = words[1:]
        if nouns:
            first, alone = self._named(nouns[0]), len(nouns) == 1
            if alone and len(words) > 1 and words[0] in first and is_ing(words[1]):
                yield Clause("is", nouns[0], " ".join(words[1:]))  # bottle-standing
                return
            if alone and words[0] in first and is_there(words[1:]):
                yield from there(words[1:], nouns[0])  # trolley-in-lift
                return
            acts = self._things.act(nouns[0].objects)
            words = without_kind(words, first, alone=alone, acts=acts)
            if not alone and words[-1] in self._named(nouns[-1]) and len(words) > 2:
                words = words[:-1] if words[-2] in PREPOSITIONS else words  # inserted-in-slot
        if words[-1] == "top" and words[0] in PREPOSITIONS and len(nouns) > 1:
            words = [*words, "of"]
        if words[-1] == "of" and len(words) > 1 and len(nouns) > 1 and words[-2] != "top":
            kept = words[0] in PREPOSITIONS or verb_form(words[0]) is not None  # in front of
            words = words if kept else words[:-1]
            if not kept and words[-1] in self._named(nouns[0]) - self._named(nouns[1]):
                whose = [f"the {' '.join(words)} of {nouns[1].said}", *self._others(nouns[2:])]
                yield Clause("is", nouns[0], " ".join(whose))  # wheel_of(wheel, bike)
                return
        if not nouns:
            yield from of_nothing(words)
        elif words[0] == "no" and len(words) > 2 and words[-1] in PREPOSITIONS:
            where = self._phrases.placed(nouns[0], words[-1])  # no-puncture-in(wheel)
            yield Clause("is", Noun("there"), f"no {' '.join(words[1:-1])} {where}")
        elif (
            len(words) > 1
            and words[0] in lexicon.AGENTS | lexicon.HANDS
            and (words[1] in ("has", "have") or does_verb(words[1]))
        ):
            yield from self._of_agent(words, nouns)
        elif len(words) == 2 and words[-1] in ("has", "have") and words[0] not in PREPOSITIONS:
            who, what = Noun(f"the {' '.join(words[:-1])}"), self._others(nouns, plain=True)
            yield Clause("does", who, f"have {' '.join(what)}")
        elif words[0] in ("have", "has", "got", "having", "possess", "possesses", "owns", "own"):
            yield from self._having(words[1:], nouns)
        elif words[0] == "can" and len(words) > 1 and verb_form(words[1]) is not None:
            yield Clause(
                "can", nouns[0], " ".join([*words[1:], *self._others(nouns[1:], plain=True)])
            )
        elif words[-1] in PREPOSITIONS and len(nouns) > 1 and does(words):
            yield from self._verb(words, nouns)
        elif words[-1] in PREPOSITIONS and (len(words) == 1 or len(nouns) > 1):
            yield from self._where(words, nouns, predicate)
        elif words[0] in PREPOSITIONS and len(words) > 1:
            yield from self._at_something(words, nouns)
        elif len(words) > 1 and len(nouns) == 1 and self._switches(words):
            *switched, state = words
            placed = self._things.are_places(nouns[0].objects)
            where = self._phrases.placed(nouns[0]) if placed else f"of {nouns[0].said}"
            thing = Noun(f"the {' '.join(switched)} {where}", plural=plural(switched[-1]))
            yield Clause("is", thing, state)
        elif words[-1] in PREPOSITIONS and (
            (verb_form(words[0]) or ("", Form.BASE))[1] is Form.BASE
        ):
            yield from self._somebody_is_at(words, nouns)
        else:
            yield from self._verb(words, nouns)

    def _switches(self, words: list[str]) -> bool:
        """Whether words say that something is on or off: light-on, red-light-on; bus-on, where
        bus-off is."""
        other = {"on": "off", "off": "on"}.get(words[-1])
        *which, thing = words[:-1]
        if other is None or not all(word in lexicon.SIDES for word in which):
            return False
        if which:
            return thing in lexicon.SWITCHED
        ones = [name for name, kinds in self._task.predicates.items() if len(kinds) == 1]
        contrary = any(self._things.words(name) == [words[0], other] for name in ones)
        return words[0] in lexicon.SWITCHED or contrary

    def _of_agent(self, words: list[str], nouns: list[Noun]) -> Iterator[Clause]:
        """robot_has(x), gripper-holding(x)."""
        who = Noun(f"the robot's {words[0]}" if words[0] in lexicon.HANDS else f"the {words[0]}")
        rest = " ".join([*words[2:], *self._others(nouns, plain=True)])
        form = verb_form(words[1])
        if form is not None and form[1] is Form.THIRD and words[1] != "has":  # robot-holds(x)
            yield Clause("is", who, f"{ing(form[0])} {rest}")
        elif words[1] in ("has", "have"):
            yield Clause("does", who, f"have {rest}")
        else:
            yield Clause("is", who, f"{words[1]} {rest}")

    def _having(self, words: list[str], nouns: list[Noun]) -> Iterator[Clause]:
        first, *rest = nouns
        spoken = [word for word in words if word.isalpha()]
        if rest:
            second = {*self._things.nouns(rest[0].objects), rest[0].parameter}
            spoken = [] if set(spoken) & second else spoken
            thing = f"{' '.join(words)} " if spoken else ""
            yield Clause(
                "does",
                first,
                f"have {thing and indefinite_article(thing) + ' '}"
                f"{thing}{' '.join(self._others(rest, plain=not spoken))}",
            )
            return
        acting = self._things.act(first.objects)
        matches = set(spoken) & {*self._things.nouns(first.objects), first.parameter}
        if not spoken or (matches and not acting) or not (acting or words):
            yield Clause("does", ROBOT, f"have {first.said}")
            yield Clause("is", ROBOT, f"in possession of {first.said}")
        else:
            yield Clause("does", first, f"have {some(words)}")

    def _where(self, words: list[str], nouns: list[Noun], predicate: str) -> Iterator[Clause]:
        """on(a, b); robot_at(r, l); next_to(a, b); set_in(w, l); at(l)."""
        *before, preposition = words
        if len(nouns) == 1:
            yield from self._alone(preposition, nouns[0], predicate)
            return
        first, second, *rest = nouns
        if preposition == "between" and rest:
            second, rest = Noun(f"{second.said} and {rest[0].said}"), rest[1:]
        said = self._others(rest)
        kinds = self._things.nouns(first.objects) | {"robot", "object", "thing", first.parameter}
        if before and before[-1] not in kinds:
            if before[0] in ROADS:
                yield Clause(
                    "is",
                    Noun("there"),
                    f"{indefinite_article(before[0])} "
                    f"{' '.join(before)} from {first.said} to {second.said}",
                )
                return
            tail = self._phrases.placed(second, preposition)
            yield Clause("is", first, " ".join([*before, tail, *said]))
            return
        if self._things.hold(second.objects) and preposition in ("in", "on", "at"):
            yield Clause("is", first, " ".join([f"in {second.said}", *said]))
            yield Clause("is", second, f"holding {first.said}")
            return
        place = self._phrases.placed(second, preposition)
        yield Clause("is", first, " ".join([place, *said]))
        if place.startswith(f"{preposition} ") and preposition in SAME:
            yield Clause("is", first, " ".join([SAME[preposition], second.said, *said]))
        elif preposition == "on":
            yield Clause("does", first, " ".join(["lie", place, *said]))
        else:
            yield Clause("can", first, " ".join(["be found", place, *said]))

    def _alone(self, preposition: str, noun: Noun, predicate: str) -> Iterator[Clause]:
        """at(place), near(thing), on(lamp), on(car) where board adds it."""
        adds = [
            schema.name
            for schema in self._task.schemas
            if any(e.literal.positive and e.literal.predicate == predicate for e in schema.effects)
        ]
        if preposition in ("on", "in", "aboard") and any("board" in name for name in adds):
            yield Clause("is", noun, "on board")
        elif preposition in ("on", "off"):
            yield Clause("is", noun, preposition)
            yield Clause("is", noun, f"switched {preposition}")
        elif preposition in ("in", "inside", "out", "outside", "up", "down", "above", "below"):
            yield Clause("is", noun, {"in": "inside"}.get(preposition, preposition))
        else:
            place = self._phrases.stood_at(noun, preposition)
            yield Clause("is", ROBOT, place)
            yield from self._elsewhere_said(ROBOT, place, preposition)

    def _elsewhere_said(self, subject: Noun, place: str, written: str) -> Iterator[Clause]:
        other = self._phrases.another(place)
        if other != place and (written != "at" or place.startswith("in ")):
            yield Clause("is", subject, other)
        else:
            yield Clause("can", subject, f"be found {place}")

    def _at_something(self, words: list[str], nouns: list[Noun]) -> Iterator[Clause]:
        """on_table(x), in_hand(x, h), at_robot(place)."""
        preposition, *named = words
        first, *rest = nouns
        what = " ".join(named)
        if rest and self._things.hold(rest[0].objects):
            yield Clause("is", first, " ".join([f"in {rest[0].said}", *self._others(rest[1:])]))
            yield Clause("is", rest[0], f"holding {first.said}")
        elif named[-1] in lexicon.HANDS:
            holder = rest[0] if rest and self._things.act(rest[0].objects) else ROBOT
            yield from in_hand(first, what, holder)
        elif not rest and preposition in ("at", "in") and self._goes_about(named[-1], first):
            subject = Noun(f"the {'robot' if what == 'robby' else what}")
            place = self._phrases.stood_at(first, preposition)
            yield Clause("is", subject, place)
            yield from self._elsewhere_said(subject, place, preposition)
        elif rest and named[-1] in self._things.nouns(rest[0].objects):
            yield Clause("is", first, f"{preposition} {rest[0].said}")
        elif not rest and named[-1] in self._things.nouns(first.objects):  # at_bench(bench)
            place = f"{preposition} {first.said}"
            yield Clause("is", ROBOT, place)
            yield from self._elsewhere_said(ROBOT, place, preposition)
        elif not rest and is_there(words):
            yield from there(words, first)

    def _goes_about(self, word: str, noun: Noun) -> bool:
        """Whether a word is who is at a place: at-robot(room), not in-van(patient)."""
        within = word in lexicon.INSIDE and not self._things.are_places(noun.objects)
        return word in lexicon.AGENTS and not within

    def _somebody_is_at(self, words: list[str], nouns: list[Noun]) -> Iterator[Clause]:
        """robot_at(place), lift-at(floor)."""
        *who, preposition = words
        if len(who) > 1 and (is_done(who[-1]) or is_ing(who[-1])):  # windlass-left-at
            aimed = (verb_form(who[-1]) or ("", None))[0] in lexicon.DIRECTED
            plain = f"{preposition} {nouns[0].said}"
            where = plain if aimed else self._phrases.placed(nouns[0], preposition)
            yield Clause("is", part(" ".join(who[:-1])), f"{who[-1]} {where}")
            return
        name = " ".join(who)
        subject = Noun(f"the {'robot' if name == 'robby' else name}")
        place = self._phrases.stood_at(nouns[0], preposition)
        if who[-1] in lexicon.MASS:
            yield Clause("is", Noun("there"), f"{name} {place}")
            yield Clause("is", Noun("there"), f"any {name} {place}")
            return
        yield Clause("is", subject, place)
        yield from self._elsewhere_said(subject, place, preposition)

    def _verb(self, words: list[str], nouns: list[Noun]) -> Iterator[Clause]:
        side = len(words) > 1 and words[0] in lexicon.SIDES  # the left hand; not what was left
        of_it = side and words[1] in lexicon.HANDS | lexicon.PARTS
        alone = words[0] in ADJECTIVES and len(words) == 1
        form = None if alone or of_it else verb_form(words[0])
        if form is not None and words[0] not in lexicon.HANDS and not self._is_noun(words, nouns):
            yield from of_verb(self._phrases, form, words, nouns, self._others)
        else:
            yield from of_noun(self._phrases, words, nouns, self._others)

    def _is_noun(self, words: list[str], nouns: list[Noun]) -> bool:
        """Whether a base form is meant as a noun: sample(rover, spot), board(x)."""
        (_, form) = verb_form(words[0]) or ("", Form.ING)
        if form is not Form.BASE or participle(words[0]) == words[0]:
            return False
        return not (words[0] in PLAIN and len(nouns) > 1)

    def _others(self, nouns: list[Noun], *, plain: bool = False) -> list[str]:
        """Further things, with the prepositions that their names or kinds suggest."""
        said: list[str] = []
        for noun in nouns:
            if plain and not said:
                said.append(noun.said)
            elif noun.parameter in ("from", "to", "with", "by", "on", "in", "at", "into"):
                said.append(f"{noun.parameter} {noun.said}")
            elif len(noun.objects) == 1 and self._things.act(noun.objects):
                continue  # there is one robot: whose else
            elif self._things.hold(noun.objects):
                said.append(f"with {noun.said}")
            elif self._things.act(noun.objects):
                said.append(f"by {noun.said}")
            elif self._things.are_places(noun.objects):
                said.append(self._phrases.placed(noun))
            else:
                said.append(f"with {noun.said}")
        return said
