"""A state, read from a file that a person or another program wrote."""

import json
from collections.abc import Iterator
from pathlib import Path

from tpvqa.errors import PDDLError, shown
from tpvqa.pddl.arithmetic import COMPARISONS, VALUE, Values, number, values_in, written
from tpvqa.pddl.atoms import Atom, State
from tpvqa.pddl.lines import lines_of
from tpvqa.pddl.numeric import Numeric
from tpvqa.pddl.task import Task
from tpvqa.text_files import read_text


def read_state(path: Path, task: Task) -> State:
    """Read a state of a task.

    The file holds one atom a line, `(on plate table)` or `on(plate, table)`, with comments after
    `;` or `#`; or a JSON list of such strings or of lists such as `["on", "plate", "table"]`.
    The value of a number is `(= (battery) 60)` or `["=", "battery", "60"]`.
    Facts that no action changes may be left out: they are taken from the problem.

    Raises:
        PDDLError: The file is missing, or an atom in it is none of this task's; with its line.
    """
    text = read_text(path, PDDLError, what="state file")
    as_json = text.lstrip()[:1] in ("[", "{")
    state: set[Atom] = set()
    for line, words in _json_atoms(text, path) if as_json else _lines(text):
        if words.count("(") != words.count(")"):
            bracket = ")" if words.count("(") > words.count(")") else "("
            raise PDDLError(f"{shown(words)}: a {bracket!r} is missing", file=path, line=line)
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
        if task.numeric is not None and atom.predicate in COMPARISONS:
            _see_value(atom, values_in(frozenset(state)), task.numeric, path, line)
        state.add(atom)
    if task.numeric is not None:
        given = values_in(frozenset(state))
        missing = [words for words in values_in(task.numeric.init) if words not in given]
        if missing:
            said = f"({' '.join(min(missing))})"
            raise PDDLError(f"it gives {said} no value; add (= {said} …)", file=path)
    return frozenset(state) | task.static


def _see_value(atom: Atom, given: Values, numbers: Numeric, path: Path, line: int | None) -> None:
    """See that an atom gives a number that changes its one value."""
    words, why = atom.arguments[:-1], ""
    if atom.predicate != VALUE:
        why = "it compares; a state says what a number is, e.g. (= (battery) 60)"
    elif words[0] not in numbers.changed:
        why = f"no action changes {words[0]}; its value is the problem's, leave it out"
    elif given.get(words, number(atom.arguments[-1])) != number(atom.arguments[-1]):
        why = f"it has the value {written(given[words])} already"
    if why:
        raise PDDLError(f"{atom.pddl()}: {why}", file=path, line=line)


def _lines(text: str) -> list[tuple[int | None, str]]:
    atoms: list[tuple[int | None, str]] = []
    for row, line in enumerate(lines_of(text), start=1):
        words = line.split(";", 1)[0].split("#", 1)[0].strip()
        # Several atoms in PDDL's notation may share a line.
        atoms += [(row, part) for part in _parts(words)]
    return atoms


def _parts(words: str) -> Iterator[str]:
    """The atoms of a line; parentheses within them are those of numbers, `(= (battery) 60)`."""
    depth = began = 0
    for at, letter in enumerate(words):
        depth += (letter == "(") - (letter == ")")
        if letter == ")" and depth <= 0:
            yield words[began : at + 1]
            depth, began = 0, at + 1
    if words[began:].strip():
        yield words[began:].strip()


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
    at, row = 0, 1  # where the last entry stands; -1 once one was written otherwise
    for nth, entry in enumerate(entries, start=1):
        line = None
        if isinstance(entry, list) and entry and all(isinstance(word, str) for word in entry):
            entry = Atom(entry[0], tuple(entry[1:])).pddl()
        elif isinstance(entry, str) and at >= 0:
            found = text.find(json.dumps(entry), at)
            if found >= 0:
                line = row = row + text.count("\n", at, found)
            at = found
        if not isinstance(entry, str):
            raise PDDLError(
                f"entry {nth} of the list is no atom: {shown(json.dumps(entry))}; expected "
                '"(on plate table)" or ["on", "plate", "table"]',
                file=path,
            )
        atoms.append((line, entry))
    return atoms
