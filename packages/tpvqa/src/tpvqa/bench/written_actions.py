"""A task's actions by how a log writes them."""

from tpvqa.errors import PDDLError
from tpvqa.pddl import Action, Task


class WrittenActions(dict[str, Action]):
    """Ground actions by their PDDL, e.g. `(pick_up plate table left)`.

    Those that can be reached from the initial state are there; others, which a plan from another
    state may take or whose objects were left out, are made when they are asked for.
    """

    def __init__(self, task: Task):
        super().__init__({action.pddl(): action for action in task.ground_actions()})
        self._task = task

    def __missing__(self, written: str) -> Action:
        name, *arguments = written.strip("()").split() or [""]
        try:
            action = self[written] = self._task.action(name, arguments)
        except PDDLError as error:
            raise KeyError(written) from error
        return action
