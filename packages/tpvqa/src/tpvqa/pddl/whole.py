"""What an author wrote of a domain, where actions last: whole actions, and facts that are asked."""

from collections.abc import Iterator
from dataclasses import replace

from tpvqa.pddl.lasting import Phase
from tpvqa.pddl.schema import ActionSchema
from tpvqa.pddl.task import Task


def whole_actions(task: Task) -> Iterator[ActionSchema]:
    """The actions by their author's names: one that lasts needs and does what its parts do."""
    lasting = task.lasting
    by_name = {schema.name: schema for schema in task.schemas}
    for schema in task.schemas:
        name = None if lasting is None else lasting.name_of(schema.name)
        if name is None:
            yield schema
        elif schema.name == f"{Phase.START}-{name}":
            end = by_name[f"{Phase.END}-{name}"]
            yield replace(schema, name=name, effects=(*schema.effects, *end.effects))


def seen_predicates(task: Task) -> list[str]:
    """The predicates of facts that change, but for those that say that an action runs."""
    running = frozenset[str]() if task.lasting is None else task.lasting.predicates
    return [n for n in task.predicates if n in task.fluents | task.derived and n not in running]
