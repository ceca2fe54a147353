"""World files: how a domain behaves where it is simulated."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import yaml

from tpvqa.errors import WorldError
from tpvqa.pddl import Action, State, Task
from tpvqa.worlds.undo import Outcome, Pattern, UndoRule

R = TypeVar("R")


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
    """

    undo: tuple[UndoRule, ...] = ()
    rebind: tuple[Rebinding, ...] = ()


def load_world_file(path: Path | str | None, task: Task) -> WorldRules:
    """Read a world file; without one nothing can be undone.

    Raises:
        WorldError: The file is missing or broken; the message names the place.
    """
    if path is None:
        return WorldRules()
    try:
        document = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise WorldError(f"{path}: cannot be read ({error.strerror})") from error
    except yaml.YAMLError as error:
        raise WorldError(f"{path}: not valid YAML: {error}") from error
    if not isinstance(document, dict) or not set(document) <= {"undo", "rebind"}:
        raise WorldError(f"{path}: expected the lists `undo` and `rebind`, and nothing else")
    return WorldRules(
        undo=tuple(_each(document, "undo", path, lambda entry: _undo_rule(entry, task))),
        rebind=tuple(_each(document, "rebind", path, lambda entry: _rebinding(entry, task))),
    )


def _each(
    document: dict[str, Any], field: str, path: Path | str, read: Callable[[Any], R]
) -> Iterator[R]:
    entries = document.get(field) or []
    if not isinstance(entries, list):
        raise WorldError(f"{path}: expected a list under `{field}:`")
    for number, entry in enumerate(entries, 1):
        try:
            yield read(entry)
        except (ValueError, TypeError) as error:
            raise WorldError(f"{path}: entry {number} under `{field}`: {error}") from error


def _rebinding(entry: Any, task: Task) -> Rebinding:
    if not isinstance(entry, dict) or set(entry) != {"action", "argument", "to"}:
        raise ValueError("expected the fields `action`, `argument` and `to`")
    schema = next((each for each in task.schemas if each.name == entry["action"]), None)
    if schema is None:
        raise ValueError(f"the domain has no action {entry['action']!r}")
    names = [parameter.name for parameter in schema.parameters]
    if entry["argument"] not in names:
        raise ValueError(f"{schema.name} has no argument {entry['argument']!r}: {', '.join(names)}")
    pattern = _pattern(entry["to"], task)
    if entry["argument"] not in pattern.terms:
        raise ValueError(f"`to` must speak of {entry['argument']}")
    return Rebinding(schema.name, tuple(names), entry["argument"], pattern)


def _undo_rule(entry: Any, task: Task) -> UndoRule:
    if not isinstance(entry, dict) or not isinstance(entry.get("fact"), str):
        raise ValueError("expected `fact: (predicate ?x …)` and a list of `outcomes`")
    outcomes = entry.get("outcomes")
    if not isinstance(outcomes, list) or not outcomes:
        raise ValueError(f"{entry['fact']} has no `outcomes`")
    return UndoRule(
        _pattern(entry["fact"], task), tuple(_outcome(outcome, task) for outcome in outcomes)
    )


def _outcome(entry: Any, task: Task) -> Outcome:
    fields = {"say", "last", "when", "unless", "add", "delete"}
    if not isinstance(entry, dict) or not set(entry) <= fields:
        raise ValueError(f"an outcome has only the fields {', '.join(sorted(fields))}")

    def patterns(name: str) -> tuple[Pattern, ...]:
        return tuple(_pattern(text, task) for text in entry.get(name) or ())

    last = entry.get("last")
    return Outcome(
        say=str(entry.get("say", "it is undone")),
        last=None if last is None else _pattern(last, task),
        when=patterns("when"),
        unless=patterns("unless"),
        add=patterns("add"),
        delete=patterns("delete"),
    )


def _pattern(text: Any, task: Task) -> Pattern:
    if not isinstance(text, str):
        raise TypeError(f"{text!r} is not an atom; write it as (predicate ?x …)")
    pattern = Pattern.parse(text)
    if pattern.predicate not in task.predicates:
        raise ValueError(f"{text}: the domain has no predicate {pattern.predicate!r}")
    arity = len(task.predicates[pattern.predicate])
    if len(pattern.terms) != arity:
        raise ValueError(f"{text}: {pattern.predicate} takes {arity} objects")
    return pattern
