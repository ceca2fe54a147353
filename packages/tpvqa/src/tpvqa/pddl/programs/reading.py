"""A logic program → actions, fluents, effects: its facts, sorted and checked.

docs/planners.md says which predicates are read. All others are the program's own.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from difflib import get_close_matches
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from tpvqa.errors import GroundingTimedOut, MissingExtraError, PDDLError, PlannerError
from tpvqa.pddl.atoms import Atom, Literal
from tpvqa.pddl.outside.asking import ask_engine

FORMS = {
    ("action", 1): "action(A)",
    ("fluent", 1): "fluent(F)",
    ("initially", 1): "initially(F)",
    ("goal", 1): "goal(C)",
    ("executable", 2): "executable(A,C)",
    ("impossible", 2): "impossible(A,C)",
    ("causes", 2): "causes(A,L)",
    ("causes", 3): "causes(A,L,C)",
    ("derived", 2): "derived(F,C)",
    ("cost", 2): "cost(A,N)",
    ("type", 2): "type(O,T)",
    ("subtype", 2): "subtype(T,U)",
}
"""What is read: A an action, F a fluent, L a fluent or -F, C an L or several, (L,…,L)."""

_WORDS = sorted({name for name, _ in FORMS})
_STEPS = {"occurs", "holds", "time", "happens"}
_LEXICAL = re.compile(r'"(?:\\.|[^"\\\n])*"|%\*.*?\*%|%[^\n]*|#\s*\w+', re.DOTALL)
_NAME = re.compile(r"[a-z][a-z0-9_-]*")

Clause = frozenset[Literal]


@dataclass
class Program:
    """What a program says.

    Attributes:
        actions: The ground actions.
        needs: Of each action, clauses that must hold: of each, one literal at least.
        effects: Of each action, a literal and the literals under which it comes to hold.
        costs: What actions cost; empty where the program says nothing of it.
        fluents: What is declared.
        init: The initial state.
        goal: What is to hold.
        rules: Derived atoms, each with the literals from which it follows.
        types: The type of each object that has one.
        parents: The parent of each type that has one.
        variables: What the arguments of an action or a fluent are called.
    """

    actions: list[Atom] = field(default_factory=list)
    needs: dict[Atom, set[Clause]] = field(default_factory=dict)
    effects: dict[Atom, set[tuple[Clause, Literal]]] = field(default_factory=dict)
    costs: dict[Atom, int] = field(default_factory=dict)
    fluents: set[Atom] = field(default_factory=set)
    init: set[Atom] = field(default_factory=set)
    goal: set[Literal] = field(default_factory=set)
    rules: set[tuple[Atom, Clause]] = field(default_factory=set)
    types: dict[str, str] = field(default_factory=dict)
    parents: dict[str, str] = field(default_factory=dict)
    variables: dict[tuple[str, str], tuple[str, ...]] = field(default_factory=dict)

    def atoms(self) -> Iterator[Atom]:
        """All atoms that it speaks of, actions left out."""
        yield from self.fluents
        yield from self.init
        yield from (literal.atom for literal in self.goal)
        for clauses in self.needs.values():
            yield from (literal.atom for clause in clauses for literal in clause)
        for effects in self.effects.values():
            for condition, literal in effects:
                yield literal.atom
                yield from (each.atom for each in condition)
        for head, condition in self.rules:
            yield head
            yield from (each.atom for each in condition)


def read_program(
    text: str, *, path: Path | None, timeout: float | None, memory: int | None
) -> Program:
    """Read a program. Nothing that it holds is run but clingo's grounding, within bounds.

    Raises:
        MissingExtraError: clingo is not installed.
        PDDLError: It is no such program.
        GroundingTimedOut: It took too long.
        PlannerError: clingo failed, or took too much memory.
    """
    if find_spec("clingo") is None:
        raise MissingExtraError("clingo", "asp", "Reading a logic program")
    _refuse_what_runs(text, path)
    reply = ask_engine(
        "tpvqa.pddl.programs.grounding", {"text": text}, seconds=timeout, memory=memory
    )
    if reply["kind"] == "timeout":
        raise GroundingTimedOut(
            f"{path or 'the program'}: grounding took more than {timeout:g} s; see that no rule "
            "makes ever new terms, as p(X+1) :- p(X) does, or give it more time"
        )
    if reply["kind"] == "crash":
        raise PlannerError(f"{path or 'the program'}: {reply['reason']} while it was grounded")
    if reply["kind"] == "error":
        raise PDDLError(reply["error"], file=path or "(program)", line=reply["line"])
    return _Reader(reply["heads"], path).read(reply["atoms"])


def _refuse_what_runs(text: str, path: Path | None) -> None:
    for found in _LEXICAL.finditer(text):
        word = re.sub(r"\s", "", found[0])
        if word in ("#include", "#script"):
            raise PDDLError(
                f"{word} is not read, as a program may be a stranger's; "
                + ("write its facts here" if word == "#include" else "say it by rules"),
                file=path or "(program)",
                line=text.count("\n", 0, found.start()) + 1,
            )


class _Reader:
    def __init__(self, heads: list[list[Any]], path: Path | None):
        self._heads, self._path = heads, path
        self._names: dict[str, str] = {}
        self._program = Program()

    def read(self, atoms: Iterable[Any]) -> Program:
        program = self._program
        by_form: dict[tuple[str, int], list[Any]] = {}
        for word, arguments, positive in sorted(atoms, key=repr):
            if positive:
                by_form.setdefault((word, len(arguments)), []).append(arguments)
        self._check_words(by_form)
        for (term,) in by_form[("action", 1)]:
            action = self._atom(term, "action", term)
            program.actions.append(action)
            program.needs[action], program.effects[action] = set(), set()
        for (term,) in by_form.get(("fluent", 1), ()):
            program.fluents.add(self._atom(term, "fluent", term))
        for (term,) in by_form.get(("initially", 1), ()):
            program.init.add(self._atom(term, "initially", term))
        for (term,) in by_form[("goal", 1)]:
            program.goal |= self._literals(term, "goal", term)
        self._read_actions(by_form)
        for head, condition in by_form.get(("derived", 2), ()):
            own = self._atom(head, "derived", head)
            program.rules.add((own, self._literals(condition, "derived", head)))
        for thing, kind in by_form.get(("type", 2), ()):
            self._once(program.types, self._name(thing), self._name(kind), "type", thing)
        for kind, above in by_form.get(("subtype", 2), ()):
            self._once(program.parents, self._name(kind), self._name(above), "subtype", kind)
        for word in ("action", "fluent"):
            for predicate, name, variables, _ in self._heads:
                lower = tuple(each.lower().strip("_") for each in variables)
                if predicate == word and all(lower) and len(set(lower)) == len(lower):
                    program.variables.setdefault((word, name), lower)
        self._check_sense()
        return program

    def _read_actions(self, by_form: dict[tuple[str, int], list[Any]]) -> None:
        program = self._program
        for form in ("executable", "impossible"):
            for term, condition in by_form.get((form, 2), ()):
                action, literals = self._action(term, form), self._literals(condition, form, term)
                if form == "executable":
                    program.needs[action] |= {frozenset([each]) for each in literals}
                else:
                    program.needs[action].add(frozenset(each.negate() for each in literals))
        for arity in (2, 3):
            for term, effect, *condition in by_form.get(("causes", arity), ()):
                action = self._action(term, "causes")
                literals = self._literals(effect, "causes", term)
                under = self._literals(condition[0], "causes", term) if condition else Clause()
                program.effects[action] |= {(under, literal) for literal in literals}
        for term, number in by_form.get(("cost", 2), ()):
            action = self._action(term, "cost")
            if not isinstance(number, int) or number < 0:
                raise self._wrong(f"{_said(number)} is no cost; write a whole number", "cost", term)
            self._once(program.costs, action, number, "cost", term)

    def _check_words(self, by_form: dict[tuple[str, int], list[Any]]) -> None:
        for word, count in by_form:
            if word in _STEPS and count == 2:
                raise self._wrong(
                    f"{word}/2 is about time steps, which are the planner's; say what an action "
                    "does by causes(A,L), and what holds at first by initially(F)",
                    word,
                )
            if word in _WORDS and (word, count) not in FORMS:
                forms = " or ".join(said for (name, _), said in FORMS.items() if name == word)
                raise self._wrong(f"{word} has {count} arguments; write {forms}", word)
            near = get_close_matches(word, _WORDS, n=1, cutoff=0.85)
            if near and word not in _WORDS:
                raise self._wrong(f"{word} is not read. Did you mean {near[0]}?", word)
        for word, said in (("action", "action(A)"), ("goal", "goal(F)")):
            if (word, 1) not in by_form:
                raise self._wrong(f"nothing says {said}; a task needs one at least")

    def _check_sense(self) -> None:
        program = self._program
        arities: dict[str, int] = {}
        for atom in program.atoms():
            if arities.setdefault(atom.predicate, len(atom.arguments)) != len(atom.arguments):
                raise self._wrong(
                    f"{atom.predicate} is used with {arities[atom.predicate]} and with "
                    f"{len(atom.arguments)} arguments; give one of them another name",
                    None,
                    [atom.predicate, [], True],
                )
        changed = {each.atom for effects in program.effects.values() for _, each in effects}
        heads = {head for head, _ in program.rules}
        both = {each.predicate for each in changed} & {each.predicate for each in heads}
        if both:
            raise self._wrong(f"{min(both)} is both derived and caused by an action; do one")
        for atom in sorted(changed - program.fluents if program.fluents else ()):
            raise self._wrong(f"an action causes {atom}, which no fluent(F) declares", "causes")
        known = {each.predicate for each in program.fluents | program.init | changed | heads}
        for atom in sorted(program.atoms()):
            if atom.predicate not in known:
                near = get_close_matches(atom.predicate, sorted(known), n=1)
                raise self._wrong(
                    f"nothing ever makes {atom if atom.arguments else atom.predicate} true"
                    + (f". Did you mean {near[0]}?" if near else "; declare it: fluent(F)"),
                    None,
                    [atom.predicate, [], True],
                )

    def _action(self, term: Any, word: str) -> Atom:
        action = self._atom(term, word, term)
        if action not in self._program.needs:
            raise self._wrong(f"there is no action({_said(term)})", word, term)
        return action

    def _literals(self, term: Any, word: str, about: Any) -> Clause:
        parts = term[1] if isinstance(term, list) and not term[0] else [term]
        return frozenset(
            Literal(self._atom([*part[:2], True], word, about), part[2])
            if isinstance(part, list) and part[0]
            else Literal(self._atom(part, word, about))
            for part in parts
        )

    def _atom(self, term: Any, word: str, about: Any) -> Atom:
        if not isinstance(term, list) or not term[0]:
            raise self._wrong(f"{_said(term)} is no fluent or action", word, about)
        if not term[2]:
            raise self._wrong(f"{_said(term)} must not be negative here", word, about)
        return Atom(self._name([term[0], [], True]), tuple(self._name(each) for each in term[1]))

    def _name(self, term: Any) -> str:
        """A term as one word: block(1) is block_n1."""
        name = _word(term)
        if _NAME.fullmatch(name) is None or name in ("and", "or", "not", "object", "either"):
            raise self._wrong(f"{_said(term)} cannot be a name; write it as a word like table_2")
        known = self._names.setdefault(name, repr(term))
        if known != repr(term):
            raise self._wrong(f"{_said(term)} and another term both become {name}; rename one")
        return name

    def _once(self, known: dict[Any, Any], key: Any, value: Any, word: str, about: Any) -> None:
        if known.setdefault(key, value) != value:
            raise self._wrong(f"{key} has more than one {word}: {known[key]}, {value}", word, about)

    def _wrong(self, message: str, word: str | None = None, about: Any = None) -> PDDLError:
        name = about[0] if isinstance(about, list) else None
        lines = [
            line
            for predicate, first, _, line in self._heads
            if word in (None, predicate) and (name is None or first == name)
        ]
        line = lines[0] if lines and (word or name) else None
        return PDDLError(message, file=self._path or "(program)", line=line)


def _word(term: Any) -> str:
    if isinstance(term, int):
        return f"n{term}" if term >= 0 else f"m{-term}"
    if isinstance(term, str):
        return term
    return "_".join([term[0].lower().replace("'", "-"), *map(_word, term[1])])


def _said(term: Any) -> str:
    if not isinstance(term, list):
        return str(term)
    inner = ",".join(map(_said, term[1]))
    return ("" if term[2] else "-") + (f"{term[0]}({inner})" if inner or not term[0] else term[0])
