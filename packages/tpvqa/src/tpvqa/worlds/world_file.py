"""World files: how a domain behaves where it is simulated."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from tpvqa.errors import PDDLError, WorldFileError, suggestion, suggestion_or_list
from tpvqa.pddl import Action, State, Task
from tpvqa.pddl.pattern import Pattern, check_together
from tpvqa.worlds.numbers import NumberChange, NumberRule, number_rule
from tpvqa.worlds.sensing import Occasion, ReportRule, SensedRule
from tpvqa.worlds.shown import ShownRule
from tpvqa.worlds.stated import stated_pattern
from tpvqa.worlds.undo import Reversal, UndoRule
from tpvqa.yaml_places import Place, read_yaml

SECTIONS = ("undo", "rebind", "sensed", "reports", "shown", "numbers")


@dataclass(frozen=True, slots=True)
class Rebinding:
    """An argument that the robot's skill does not take: it is what holds in truth.

    Attributes:
        action: The action's name.
        parameters: Its parameters.
        argument: The one that is not taken.
        to: The true fact that gives it.
    """

    action: str
    parameters: tuple[str, ...]
    argument: str
    to: Pattern

    def apply(self, action: Action, state: State, task: Task) -> Action:
        """The action that the skill truly is, where the fact leaves no choice.

        What has no cost there is no action: then it is the one that was named, which fails.
        """
        if action.name != self.action:
            return action
        binding = dict(zip(self.parameters, action.arguments, strict=True))
        del binding[self.argument]
        found = [self.to.match(atom, binding, task) for atom in state]
        matches = [match for match in found if match is not None]
        if len(matches) != 1:
            return action
        binding[self.argument] = matches[0][self.argument]
        arguments = [binding[name] for name in self.parameters]
        return (
            task.action(action.name, arguments) if task.has_cost(action.name, arguments) else action
        )


@dataclass(frozen=True, slots=True)
class WorldRules:
    """What a world file says.

    Attributes:
        undo: What disturbances can undo.
        rebind: Arguments that skills do not take.
        sensed: What the robot measures itself.
        reports: What skills notice of their failures; the first that is of an action counts.
        shown: What a camera shows only from certain places; the first that is of a fact counts.
        numbers: What changes numbers besides actions, and which are measured.
        nothing_undone: Whether it says that nothing can be undone, by an empty list.
    """

    undo: tuple[UndoRule, ...] = ()
    rebind: tuple[Rebinding, ...] = ()
    sensed: tuple[SensedRule, ...] = ()
    reports: tuple[ReportRule, ...] = ()
    shown: tuple[ShownRule, ...] = ()
    nothing_undone: bool = False
    numbers: tuple[NumberRule, ...] = ()


def load_world_file(path: Path | str | None, task: Task) -> WorldRules:
    """Read a world file; without one there are no rules.

    Raises:
        WorldFileError: The file is missing or broken, or does not fit the task; with file and
            line.
    """
    root = None if path is None else read_yaml(Path(path), WorldFileError)
    sections = {} if root is None else root.sections(*SECTIONS)
    return WorldRules(
        undo=tuple(_undo_rule(entry, task) for entry in _items(sections, "undo")),
        rebind=tuple(_rebinding(entry, task) for entry in _items(sections, "rebind")),
        sensed=tuple(_sensed_rule(entry, task) for entry in _items(sections, "sensed")),
        reports=tuple(_report_rule(entry, task) for entry in _items(sections, "reports")),
        shown=tuple(_shown_rule(entry, task) for entry in _items(sections, "shown")),
        nothing_undone="undo" in sections and not _items(sections, "undo"),
        numbers=tuple(number_rule(entry, task) for entry in _items(sections, "numbers")),
    )


def _items(sections: Mapping[str, Place], name: str) -> list[Place]:
    return list(sections[name].items()) if name in sections else []


def _rebinding(entry: Place, task: Task) -> Rebinding:
    parts = entry.sections("action", "argument", "to")
    if len(parts) < 3:
        raise entry.wrong("an entry needs 'action', 'argument' and 'to'")
    name = _action_name(parts["action"], task)
    (schema,) = (schema for schema in task.schemas if schema.name == name)
    names = [parameter.name for parameter in schema.parameters]
    argument = parts["argument"].text().lower()
    if argument not in names:
        raise parts["argument"].wrong(
            f"{name} has no parameter {argument!r}{suggestion_or_list(argument, names)}"
        )
    pattern = stated_pattern(parts["to"], task)
    if argument not in pattern.variables:
        raise parts["to"].wrong(f"{pattern} does not speak of {argument}, which it is to give")
    return Rebinding(name, tuple(names), argument, pattern)


def _action_name(place: Place, task: Task) -> str:
    name, known = place.text().lower(), [schema.name for schema in task.schemas]
    if name not in known:
        raise place.wrong(f"the domain has no action {name!r}{suggestion_or_list(name, known)}")
    return name


def _sensed_rule(entry: Place, task: Task) -> SensedRule:
    parts = entry.sections("fact", "right", "claims", "at")
    if "fact" not in parts:
        raise entry.wrong("an entry needs 'fact', e.g. fact: (in_hand ?x ?h)")
    fact = _pattern(parts["fact"], task)
    right = parts["right"].share() if "right" in parts else 1.0
    claims = parts["claims"].share() if "claims" in parts else max(right, 1 - right)
    if claims < 0.5:
        raise parts["claims"].wrong("a reading of less than 0.5 says the opposite; give 0.5 to 1")
    at = frozenset({Occasion.ACTION})
    if "at" in parts:
        at = frozenset(map(_occasion, parts["at"].texts()))
        if not at:
            raise parts["at"].wrong(f"name an occasion: {', '.join(Occasion)}")
    return SensedRule(fact, right, claims, at)


def _occasion(place: Place) -> Occasion:
    word = place.text().lower()
    if word not in set(Occasion):
        raise place.wrong(f"{word!r} is no occasion{suggestion_or_list(word, Occasion)}")
    return Occasion(word)


def _report_rule(entry: Place, task: Task) -> ReportRule:
    parts = entry.sections("action", "notices", "false_alarms", "refuses")
    return ReportRule(
        _action_name(parts["action"], task) if "action" in parts else None,
        parts["notices"].share() if "notices" in parts else 0.0,
        parts["false_alarms"].share() if "false_alarms" in parts else 0.0,
        parts["refuses"].share() if "refuses" in parts else None,
    )


def _shown_rule(entry: Place, task: Task) -> ShownRule:
    parts = entry.sections("fact", "where")
    if "fact" not in parts or "where" not in parts:
        raise entry.wrong("an entry needs 'fact' and 'where', e.g. where: (near ?c)")
    fact, where = _pattern(parts["fact"], task), []
    for place in parts["where"].texts():
        pattern = _pattern(place, task)
        if unbound := pattern.variables - fact.variables:
            raise place.wrong(f"{pattern}: {fact} does not speak of {min(unbound)}")
        where.append(pattern)
    if not where:
        raise parts["where"].wrong("name what has to hold, e.g. where: (near ?c)")
    return ShownRule(fact, tuple(where))


def _pattern(place: Place, task: Task) -> Pattern:
    try:
        return Pattern.parse(place.text(), task)
    except PDDLError as error:
        raise place.wrong(error.message) from None


def _undo_rule(entry: Place, task: Task) -> UndoRule:
    parts = entry.sections("fact", "outcomes")
    outcomes = _items(parts, "outcomes")
    if "fact" not in parts or not outcomes:
        raise entry.wrong("an entry needs 'fact', e.g. fact: (opened ?c), and a list of 'outcomes'")
    fact = stated_pattern(parts["fact"], task)
    return UndoRule(fact, tuple(_reversal(outcome, fact, task) for outcome in outcomes))


def _reversal(entry: Place, fact: Pattern, task: Task) -> Reversal:
    parts = entry.sections("say", "last", "when", "unless", "add", "delete", "numbers")

    def patterns(name: str, *before: Pattern, bound: bool = False) -> tuple[Pattern, ...]:
        found: list[Pattern] = []
        for place in parts[name].texts() if name in parts else ():
            pattern = stated_pattern(place, task)
            known = frozenset[str]().union(*(each.variables for each in before))
            if bound and not pattern.variables <= known:
                unbound = min(pattern.variables - known)
                raise place.wrong(
                    f"{pattern}: nothing says what {unbound} stands for"
                    f"{suggestion(unbound, known)} 'fact', 'last' and 'when' bind variables"
                )
            try:
                check_together((*before, *found, pattern), task)
            except PDDLError as error:
                raise place.wrong(error.message) from None
            found.append(pattern)
        return tuple(found)

    last = patterns("last", fact)
    if len(last) > 1:
        raise parts["last"].wrong("expected one fact")
    when = patterns("when", fact, *last)
    known = frozenset[str]().union(*(each.variables for each in (fact, *last, *when)))
    changes = parts["numbers"].texts() if "numbers" in parts else ()
    return Reversal(
        say=parts["say"].text() if "say" in parts else "it is undone",
        last=last[0] if last else None,
        when=when,
        unless=patterns("unless", fact, *last),
        add=patterns("add", fact, *last, *when, bound=True),
        delete=patterns("delete", fact, *last, *when, bound=True),
        numbers=tuple(NumberChange.parse(place, known, task) for place in changes),
    )
