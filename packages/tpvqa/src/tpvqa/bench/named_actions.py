"""A task's actions by their PDDL, those that only a fault opens up, too."""

from tpvqa.pddl import Action, Atom, Task


class NamedActions(dict[str, Action]):
    """Ground actions by their PDDL; others than those that can be reached are made when asked for.

    Where something is undone, or elsewhere than the problem says, a plan may hold actions that the
    initial state does not lead to.

    Args:
        task: Gives the actions.
    """

    def __init__(self, task: Task):
        super().__init__((action.pddl(), action) for action in task.ground_actions())
        self._task = task

    def __missing__(self, pddl: str) -> Action:
        words = Atom.parse(pddl)
        action = self[pddl] = self._task.action(words.predicate, words.arguments)
        return action
