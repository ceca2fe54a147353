"""Every state of a task, one by one."""

from tpvqa.pddl import State, Task


def every_state(task: Task, *begun: State) -> set[State]:
    """What actions lead to from some states; the initial one where none is given."""
    seen = set(begun or [task.init])
    waiting = list(seen)
    while waiting:
        state = waiting.pop()
        for action in task.ground_actions():
            if task.applicable(state, action):
                after = task.apply(state, action)
                if after not in seen:
                    seen.add(after)
                    waiting.append(after)
    return seen
