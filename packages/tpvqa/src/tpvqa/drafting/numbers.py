"""Questions about numbers, drafted from the names of functions."""

import json
from collections.abc import Iterator

from tpvqa.drafting.names import words_of
from tpvqa.pddl import Task


def numbers_section(task: Task) -> Iterator[str]:
    """The section of a questions file about the numbers that actions change; nothing for none."""
    if task.numeric is None or not task.numeric.changed:
        return
    yield ""
    yield "numbers:   # {comparison} is: at least, at most, more than, less than, exactly"
    for name in sorted(task.numeric.changed):
        arguments = [variable.lstrip("?") for variable, _ in task.numeric.functions[name]]
        of = " and ".join(f"the {{{each}}}" for each in arguments)
        said = f"the {' '.join(words_of(name))}{' of ' * bool(of)}{of}"
        question = json.dumps(f"Is {said} {{comparison}} {{number}}?")
        yield f"  {name}: {question}   # LOOK: name the unit and where it is shown"
