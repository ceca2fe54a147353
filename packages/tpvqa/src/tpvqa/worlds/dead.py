"""Skills that never work."""

from collections.abc import Sequence
from dataclasses import dataclass

from tpvqa.errors import WorldError, suggestion_or_list
from tpvqa.pddl import Action, Task

ANY = "_"
"""Stands for any object."""


@dataclass(frozen=True, slots=True)
class Dead:
    """Actions that never do anything.

    Attributes:
        skills: Each an action's name, and the first of its arguments for which it is dead; `_`
            for any.
    """

    skills: tuple[tuple[str, ...], ...] = ()

    @classmethod
    def parse(cls, text: str | None, task: Task) -> "Dead":
        """Read what a user wrote: `pick_up apple + wash`.

        Raises:
            WorldError: The task has no such action or object, or none of the kind it takes; or
                nothing stands between two signs.
        """
        parts = [part.strip(" ()").lower().split() for part in (text or "").split("+")]
        if text and text.strip() and not all(parts):
            raise WorldError(f"--dead: a skill is missing before or behind a + in {text!r}")
        return cls(tuple(_checked(words, task) for words in parts if words))

    def holds(self, action: Action) -> bool:
        """Whether an action never works."""
        return any(
            name == action.name
            and all(
                thing in (ANY, argument)
                for thing, argument in zip(objects, action.arguments, strict=False)
            )
            for name, *objects in self.skills
        )


NOTHING_DEAD = Dead()
"""Every skill works, as often as it does."""


def _checked(words: Sequence[str], task: Task) -> tuple[str, ...]:
    name, *objects = words
    schemas = {schema.name: schema for schema in task.schemas}
    if name not in schemas:
        raise WorldError(
            f"--dead: the domain has no action {name!r}{suggestion_or_list(name, schemas)}"
        )
    for thing in objects:
        if thing != ANY and thing not in task.objects:
            raise WorldError(
                f"--dead: there is no object {thing!r}{suggestion_or_list(thing, task.objects)}"
            )
    kinds = [parameter.type for parameter in schemas[name].parameters]
    fits = len(objects) <= len(kinds) and all(
        thing == ANY or task.is_a(thing, kind) for thing, kind in zip(objects, kinds, strict=False)
    )
    if not fits:
        raise WorldError(
            f"--dead: {name} takes {', '.join(kinds) or 'no objects'}, which "
            f"{' '.join(objects)} does not fit"
        )
    return tuple(words)
