"""What neither a camera nor a sensor tells, and what would."""

from collections.abc import Iterator, Mapping
from itertools import islice

from tpvqa.checking.finding import Finding, Severity, named
from tpvqa.checking.places import line_of_action, line_of_predicate
from tpvqa.checking.possible import atoms_of, needed_predicates
from tpvqa.pddl import Action, Atom, Literal, Task
from tpvqa.pddl.lasting import Phase
from tpvqa.questions import QuestionBook
from tpvqa.worlds.sensing import SensedRule
from tpvqa.worlds.world_file import WorldRules

_LOOKED_AT = 20_000
"""Ground actions whose effects are compared."""


class Telling:
    """What tells facts of a task: questions, and what the robot senses.

    Args:
        task: The task.
        book: Its questions.
        rules: Its world file.
        into: The world file's name, for what is proposed.
    """

    def __init__(self, task: Task, book: QuestionBook, rules: WorldRules, into: str):
        self.task, self.book, self.rules, self.into = task, book, rules, into

    def asked(self, literal: Literal, action: Action | None = None) -> bool:
        """Whether a VLM is asked about it."""
        return self.book.asked(literal, action)

    def sensed(self, atom: Atom) -> bool:
        """Whether the robot measures it."""
        return _senses(self.rules.sensed, atom, self.task)

    def findings(self) -> Iterator[Finding]:
        """All that cannot be told."""
        unseen = dict(self._unseen())
        for name, who in unseen.items():
            yield Finding(
                "fact-unseen",
                Severity.WARNING,
                f"{who} rests on {name}, which is never asked about and which no sensor tells",
                "It is believed from actions alone. If a sensor tells it, say so in the world file "
                "(a robot of your own says it itself, in facts).",
                named(self.task.domain_path),
                line_of_predicate(self.task, name),
                ("sensed:", f"  - fact: {_form(self.task, name)}", "    at: effect"),
                self.into,
            )
        yield from self._silent_actions(unseen)
        yield from self._alike_in_what_shows()

    def _unseen(self) -> Iterator[tuple[str, str]]:
        """Changing predicates that are needed and that nothing tells; of opposites one."""
        found: set[str] = set()
        for name, who in needed_predicates(self.task).items():
            atoms = atoms_of(self.task, name) if name in self.task.fluents else []
            if not atoms or any(self._opposite_told(atom) for atom in atoms):
                continue
            if any(each in found for atom in atoms for each in self._opposites(atom)):
                continue
            if not any(
                self.asked(Literal(atom, positive)) or self.sensed(atom)
                for atom in atoms
                for positive in (True, False)
            ):
                found.add(name)
                yield name, who

    def _opposites(self, atom: Atom) -> Iterator[str]:
        """The predicates of atoms of which exactly one holds, it or that."""
        for group in self.task.groups_of(atom):
            if group.exactly_one and len(group.atoms) == 2:
                yield from (other.predicate for other in group.atoms - {atom})

    def _opposite_told(self, atom: Atom) -> bool:
        """Whether it follows from facts that are asked: of its exactly-one group all others are."""
        return any(
            group.exactly_one
            and all(
                self.asked(Literal(other)) or self.sensed(other) for other in group.atoms - {atom}
            )
            for group in self.task.groups_of(atom)
        )

    def _silent_actions(self, unseen: Mapping[str, str]) -> Iterator[Finding]:
        """Actions whose effects nobody sees."""
        shown: dict[str, bool] = {}
        for action in islice(self.task.ground_actions(), _LOOKED_AT):
            if shown.get(action.name):
                continue
            changed = [e.literal for e in action.effects if e.literal.atom.predicate != "="]
            shown[action.name] = not changed or any(
                self.asked(each, action) or self.sensed(each.atom) for each in changed
            )
        for name in [name for name, seen in shown.items() if not (seen or self._quiet(name))]:
            (schema,) = (each for each in self.task.schemas if each.name == name)
            predicates = list(dict.fromkeys(e.literal.predicate for e in schema.effects))
            paste = [
                line
                for each in predicates
                if each not in unseen
                for line in (f"  - fact: {_form(self.task, each)}", "    at: effect")
            ]
            yield Finding(
                "effects-unseen",
                Severity.WARNING,
                f"nothing tells whether {name} worked: no effect of it is asked about or sensed",
                "Ask about an effect, let a sensor tell one, or have the skill report failures.",
                named(self.task.domain_path),
                line_of_action(self.task, name),
                (
                    *(("sensed:", *paste) if paste else ()),
                    "reports:",
                    f"  - action: {name}",
                    "    notices: 0.9   # the share of its failures that your skill notices",
                ),
                self.into,
            )

    def _quiet(self, action: str) -> bool:
        """Whether an action is a part of one that lasts, of which its end tells enough."""
        lasting = self.task.lasting
        return lasting is not None and lasting.phase_of(action) not in (None, Phase.END)

    def _alike_in_what_shows(self) -> Iterator[Finding]:
        """Actions that differ in what they do and not in what shows."""
        signatures: dict[frozenset[tuple[str, bool]], tuple[Action, frozenset[Literal]]] = {}
        told: set[frozenset[str]] = set()
        lasting = self.task.lasting
        running = frozenset[str]() if lasting is None else lasting.predicates
        for action in islice(self.task.ground_actions(), _LOOKED_AT):
            if self._quiet(action.name):
                continue
            effects = frozenset(
                e.literal for e in action.effects if e.literal.atom.predicate not in running
            )
            shown = frozenset(
                (self.book.fact(each).text if self.asked(each, action) else each.atom.pddl(),
                 each.positive)
                for each in effects
                if self.asked(each, action) or self.sensed(each.atom)
            )  # fmt: skip
            if not shown:
                continue
            other, its = signatures.setdefault(shown, (action, effects))
            pair = frozenset((other.name, action.name))
            if its == effects or len(pair) == 1 or pair in told:
                continue
            told.add(pair)
            differing = min(map(str, its ^ effects))
            yield Finding(
                "effects-alike",
                Severity.WARNING,
                f"the effects of {other.pddl()} and of {action.pddl()} cannot be told apart: all "
                f"that is asked and sensed is the same, and {differing} is not",
                "Ask about what differs, or let a sensor tell it.",
                named(self.task.domain_path),
                line_of_action(self.task, action.name),
            )


def _senses(rules: tuple[SensedRule, ...], atom: Atom, task: Task) -> bool:
    return any(rule.fact.match(atom, {}, task) is not None for rule in rules)


def _form(task: Task, predicate: str) -> str:
    return f"({' '.join((predicate, *task.predicate_variables[predicate]))})"
