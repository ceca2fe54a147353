"""A state, read from a file that a person or another program wrote."""

import json
from pathlib import Path

from tpvqa.errors import PDDLError, shown
from tpvqa.pddl.atoms import Atom, State
from tpvqa.pddl.lines import lines_of
from tpvqa.pddl.task import Task
from tpvqa.text_files import read_text


def read_state(path: Path, task: Task) -> State:
    """Read a state of a task.

    The file holds one atom a line, `(on plate table)` or `on(plate, table)`, with comments after
    `;` or `#`; or a JSON list of such strings or of lists such as `["on", "plate", "table"]`.
    Facts that no action changes may be left out: they are taken from the problem.

    Raises:
        PDDLError: The file is missing, or an atom in it is none of this task's; with its line.
    """
    text = read_text(path, PDDLError, what="state file")
    as_json = text.lstrip()[:1] in ("[", "{")
    state = set()
    for line, words in _json_atoms(text, path) if as_json else _lines(text):
        try:
            atom = Atom.parse(words)
            task.check_atom(atom)
            if atom.predicate in task.derived:
                raise PDDLError(
                    f"{atom.pddl()}: {atom.predicate} is derived, so it follows from other facts; "
                    "leave it out"
                )
        except ValueError as error:
            raise PDDLError(str(error), file=path, line=line) from None
        except PDDLError as error:
            raise PDDLError(str(error), file=path, line=line) from None
        state.add(atom)
    return frozenset(state) | task.static


def _lines(text: str) -> list[tuple[int | None, str]]:
    atoms: list[tuple[int | None, str]] = []
    for number, line in enumerate(lines_of(text), start=1):
        words = line.split(";", 1)[0].split("#", 1)[0].strip()
        # Several atoms in PDDL's notation may share a line.
        atoms += [(number, part + ")") for part in words.split(")")[:-1]] if words else []
        rest = words.rsplit(")", 1)[-1].strip()
        if rest:
            atoms.append((number, rest))
    return atoms


def _json_atoms(text: str, path: Path) -> list[tuple[int | None, str]]:
    try:
        entries = json.loads(text)
    except json.JSONDecodeError as error:
        raise PDDLError(f"this is not JSON: {error.msg}", file=path, line=error.lineno) from None
    except (RecursionError, ValueError):  # a number of thousands of digits
        raise PDDLError(
            'this is no JSON list of atoms, such as ["(on plate table)"]', file=path
        ) from None
    if not isinstance(entries, list):
        raise PDDLError('expected a JSON list of atoms, such as ["(on plate table)"]', file=path)
    atoms: list[tuple[int | None, str]] = []
    for number, entry in enumerate(entries, start=1):
        if isinstance(entry, list) and entry and all(isinstance(word, str) for word in entry):
            entry = " ".join(entry)
        if not isinstance(entry, str):
            raise PDDLError(
                f"entry {number} of the list is no atom: {shown(json.dumps(entry))}; expected "
                '"(on plate table)" or ["on", "plate", "table"]',
                file=path,
            )
        atoms.append((_line_of_entry(text, entry), entry))
    return atoms


def _line_of_entry(text: str, entry: str) -> int | None:
    """The line of an entry that is written as one string."""
    at = text.find(json.dumps(entry))
    return None if at < 0 else text.count("\n", 0, at) + 1
