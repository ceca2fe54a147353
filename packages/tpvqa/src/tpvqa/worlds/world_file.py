"""World files: how a domain behaves where it is simulated."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from tpvqa.errors import PDDLError, WorldFileError, suggestion, suggestion_or_list
from tpvqa.pddl import Action, State, Task
from tpvqa.pddl.pattern import Pattern, check_together
from tpvqa.worlds.stated import stated_pattern
from tpvqa.worlds.undo import Reversal, UndoRule
from tpvqa.yaml_places import Place, read_yaml


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
        """The action that the skill truly is, where the fact leaves no choice."""
        if action.name != self.action:
            return action
        binding = dict(zip(self.parameters, action.arguments, strict=True))
        del binding[self.argument]
        found = [self.to.match(atom, binding, task) for atom in state]
        matches = [match for match in found if match is not None]
        if len(matches) != 1:
            return action
        binding[self.argument] = matches[0][self.argument]
        return task.action(action.name, [binding[name] for name in self.parameters])


@dataclass(frozen=True, slots=True)
class WorldRules:
    """What a world file says.

    Attributes:
        undo: What disturbances can undo.
        rebind: Arguments that skills do not take.
        nothing_undone: Whether it says that nothing can be undone, by an empty list.
    """

    undo: tuple[UndoRule, ...] = ()
    rebind: tuple[Rebinding, ...] = ()
    nothing_undone: bool = False


def load_world_file(path: Path | str | None, task: Task) -> WorldRules:
    """Read a world file; without one there are no rules.

    Raises:
        WorldFileError: The file is missing or broken, or does not fit the task; with file and
            line.
    """
    root = None if path is None else read_yaml(Path(path), WorldFileError)
    sections = {} if root is None else root.sections("undo", "rebind")
    return WorldRules(
        undo=tuple(_undo_rule(entry, task) for entry in _items(sections, "undo")),
        rebind=tuple(_rebinding(entry, task) for entry in _items(sections, "rebind")),
        nothing_undone="undo" in sections and not _items(sections, "undo"),
    )


def _items(sections: Mapping[str, Place], name: str) -> list[Place]:
    return list(sections[name].items()) if name in sections else []


def _rebinding(entry: Place, task: Task) -> Rebinding:
    parts = entry.sections("action", "argument", "to")
    if len(parts) < 3:
        raise entry.wrong("an entry needs 'action', 'argument' and 'to'")
    name = parts["action"].text().lower()
    schemas = {schema.name: schema for schema in task.schemas}
    if name not in schemas:
        raise parts["action"].wrong(
            f"the domain has no action {name!r}{suggestion_or_list(name, schemas)}"
        )
    names = [parameter.name for parameter in schemas[name].parameters]
    argument = parts["argument"].text().lower()
    if argument not in names:
        raise parts["argument"].wrong(
            f"{name} has no parameter {argument!r}{suggestion_or_list(argument, names)}"
        )
    pattern = stated_pattern(parts["to"], task)
    if argument not in pattern.variables:
        raise parts["to"].wrong(f"{pattern} does not speak of {argument}, which it is to give")
    return Rebinding(name, tuple(names), argument, pattern)


def _undo_rule(entry: Place, task: Task) -> UndoRule:
    parts = entry.sections("fact", "outcomes")
    outcomes = _items(parts, "outcomes")
    if "fact" not in parts or not outcomes:
        raise entry.wrong("an entry needs 'fact', e.g. fact: (opened ?c), and a list of 'outcomes'")
    fact = stated_pattern(parts["fact"], task)
    return UndoRule(fact, tuple(_reversal(outcome, fact, task) for outcome in outcomes))


def _reversal(entry: Place, fact: Pattern, task: Task) -> Reversal:
    parts = entry.sections("say", "last", "when", "unless", "add", "delete")

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
    return Reversal(
        say=parts["say"].text() if "say" in parts else "it is undone",
        last=last[0] if last else None,
        when=when,
        unless=patterns("unless", fact, *last),
        add=patterns("add", fact, *last, *when, bound=True),
        delete=patterns("delete", fact, *last, *when, bound=True),
    )
