"""Whether the facts of labelled pictures are facts of a task: a misspelt one is taken for false."""

from collections import defaultdict

from tpvqa.errors import CalibrationError, PDDLError, cut, suggestion
from tpvqa.pddl import Atom, Task
from tpvqa.worlds.pictures import PictureSet
from tpvqa.worlds.pictures.manifest import MANIFEST, P

_NAMED = 5


def see_facts(pictures: PictureSet[P], task: Task) -> list[str]:
    """See that a set speaks of a task.

    Objects that the task does not have are no error, as a set may serve several problems.

    Returns:
        What is to be told of such objects.

    Raises:
        CalibrationError: A fact is of no predicate of the task's domain, has too few or too many
            arguments, or arguments that its predicate cannot have.
    """
    strange: dict[str, str] = {}
    seen: dict[str, None] = {}
    where = defaultdict[str, list[str]](list)
    for picture in pictures.manifest.pictures:
        for fact in (*picture.state, *sorted(picture.seen)):
            if fact not in seen:
                seen[fact] = None
                strange |= _strange_objects(Atom.parse(fact), task, pictures, picture.file)
            for name in strange.keys() & set(Atom.parse(fact).arguments):
                where[name].append(picture.file)
    return [
        f"{cut(name)} is no object of the problem{told} Facts about it, in "
        f"{len(set(where[name]))} of the pictures, are asked about by no question, and where the "
        "name is misspelt the right one counts as false."
        for name, told in list(strange.items())[:_NAMED]
    ]


def _strange_objects(atom: Atom, task: Task, pictures: PictureSet[P], file: str) -> dict[str, str]:
    try:
        task.check_atom(atom)
    except PDDLError as error:
        wanted = task.predicates.get(atom.predicate)
        unknown = [name for name in atom.arguments if name not in task.objects]
        if unknown and wanted is not None and len(wanted) == len(atom.arguments):
            return {name: suggestion(name, task.objects) for name in unknown}
        said = str(error) if str(error).endswith((".", "?")) else f"{error}."
        raise CalibrationError(
            f"{pictures.folder / MANIFEST}: {file}: {said} Write facts as the domain has them"
        ) from None
    return {}
