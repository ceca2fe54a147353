"""Facts in the files of worlds: those that a true state states, not those that follow from it."""

from tpvqa.errors import PDDLError
from tpvqa.pddl import Atom, Task
from tpvqa.pddl.pattern import Pattern
from tpvqa.yaml_places import Place


def stated_pattern(place: Place, task: Task) -> Pattern:
    """Read a form of facts, such as `(on ?x ?d - dish)`.

    Raises:
        PlacedError: It does not fit the task, or is derived.
    """
    try:
        pattern = Pattern.parse(place.text(), task)
    except PDDLError as error:
        raise place.wrong(error.message) from None
    if pattern.predicate in task.derived:
        raise place.wrong(
            f"{pattern}: {pattern.predicate} is derived, so it follows from other facts; name those"
        )
    return pattern


def stated_atom(place: Place, task: Task) -> Atom:
    """Read a fact, such as `(on apple table)`.

    Raises:
        PlacedError: It does not fit the task, is derived, or has variables.
    """
    pattern = stated_pattern(place, task)
    if pattern.variables:
        raise place.wrong(
            f"{pattern}: {min(pattern.variables)} is a variable; expected the name of an object"
        )
    return pattern.ground({})
