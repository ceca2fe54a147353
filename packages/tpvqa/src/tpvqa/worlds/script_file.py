"""Scripts: what befalls which attempt of which action (see docs/your-own-domain.md)."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from tpvqa.errors import PDDLError, WorldFileError
from tpvqa.pddl import Atom, Task
from tpvqa.worlds.stated import stated_atom
from tpvqa.yaml_places import Place, read_yaml


@dataclass(frozen=True, slots=True)
class ScriptedFault:
    """What befalls one attempt of one action.

    Attributes:
        fails: Whether the action's own effects stay out.
        add: Facts that become true after it.
        delete: Facts that end after it.
        place: File and line of the entry.
    """

    fails: bool
    add: frozenset[Atom]
    delete: frozenset[Atom]
    place: str


Script = Mapping[tuple[str, int], ScriptedFault]
"""Action, as PDDL writes it, and attempt, counted from 1 → what befalls it."""


def load_script(path: Path, task: Task) -> Script:
    """Read a script.

    Raises:
        WorldFileError: The file is missing or broken, or does not fit the task; with file and
            line.
    """
    root = read_yaml(path, WorldFileError)
    sections = {} if root is None else root.sections("script")
    if "script" not in sections:
        raise WorldFileError("expected a list under 'script:'", file=path)
    script: dict[tuple[str, int], ScriptedFault] = {}
    for entry in sections["script"].items():
        key, fault = _fault(entry, task)
        if key in script:
            raise entry.wrong(
                f"attempt {key[1]} of {key[0]} is given twice, first at {script[key].place}"
            )
        script[key] = fault
    return script


def _fault(entry: Place, task: Task) -> tuple[tuple[str, int], ScriptedFault]:
    parts = entry.sections("action", "attempt", "fails", "then")
    if "action" not in parts:
        raise entry.wrong("an entry needs 'action', e.g. action: (pick_up apple table left)")
    attempt = parts["attempt"].count() if "attempt" in parts else 1
    then = parts["then"].sections("add", "delete") if "then" in parts else {}
    changes = {
        name: frozenset(stated_atom(item, task) for item in place.texts())
        for name, place in then.items()
    }
    fault = ScriptedFault(
        fails="fails" in parts and parts["fails"].truth(),
        add=changes.get("add", frozenset()),
        delete=changes.get("delete", frozenset()),
        place=f"{entry.file}:{entry.line}",
    )
    return (_action(parts["action"], task), attempt), fault


def _action(place: Place, task: Task) -> str:
    try:
        words = Atom.parse(place.text())
        return task.action(words.predicate, words.arguments).pddl()
    except PDDLError as error:
        raise place.wrong(error.message) from None
    except ValueError:
        raise place.wrong("expected an action, e.g. (pick_up apple table left)") from None
