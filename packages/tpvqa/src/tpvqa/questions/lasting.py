"""How the parts of an action that lasts are said: by the words of the whole action."""

from collections.abc import Iterator, Mapping

from tpvqa.pddl import Task
from tpvqa.pddl.lasting import Phase
from tpvqa.questions.template import Template

_SAY = {
    Phase.START: "begin to {}",
    Phase.WHILE: "continue to {}",
    Phase.END: "finish: {}",
    Phase.CANCEL: "cancel: {}",
}
_DONE = {
    Phase.START: "began to {}",
    Phase.WHILE: "continued to {}",
    Phase.CANCEL: "cancelled: {}",
}


def parts_of(task: Task, action: str) -> tuple[str, ...]:
    """The actions that a name in a questions file stands for: of one that lasts all its parts."""
    lasting = task.lasting
    if lasting is None or action not in lasting.variables:
        return (action,)
    return tuple(schema.name for schema in task.schemas if lasting.name_of(schema.name) == action)


def words_of_parts(
    task: Task, say: Mapping[str, Template], done: Mapping[str, Template]
) -> Iterator[tuple[str, Template, Template]]:
    """How each part of an action that lasts is said, before and after.

    Args:
        task: The task.
        say: How whole actions are said.
        done: How they are said once they are done.
    """
    if task.lasting is None:
        return
    for schema in task.schemas:
        name, phase = task.lasting.name_of(schema.name), task.lasting.phase_of(schema.name)
        if name is not None and phase is not None:
            after = done[name] if phase is Phase.END else _within(_DONE[phase], say[name])
            yield schema.name, _within(_SAY[phase], say[name]), after


def questions_of_running(task: Task, say: Mapping[str, Template]) -> Iterator[tuple[str, Template]]:
    """What is asked of the facts that say that an action runs, where a file gives no words."""
    if task.lasting is not None:
        for name in task.lasting.variables:
            question = Template(("Is it true: ", *say[name].parts, " is under way?"))
            yield task.lasting.predicate(name), question


def _within(words: str, said: Template) -> Template:
    return Template((words.format(""), *said.parts))
