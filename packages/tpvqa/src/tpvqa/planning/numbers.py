"""Numbers of a ground task, as engines are given them."""

from collections.abc import Callable, Sequence
from typing import Any

from tpvqa.errors import PDDLError
from tpvqa.pddl import Action, Atom, Condition, State, Task
from tpvqa.pddl.arithmetic import ARITHMETIC, Expression, Words, number, sides, values_in, written
from tpvqa.pddl.outside.engines import taken
from tpvqa.planning.protocol import Crashed, Unfit


def no_numbers(task: Task, planner: str) -> Crashed:
    """Why a planner that knows no numbers does not plan a task in which actions change some."""
    names = "" if task.numeric is None else ", ".join(sorted(task.numeric.changed))
    what = f"actions change numbers here ({names})" if names else "numbers are compared here"
    reason = f"{what}, which {planner} does not know; {taken('numbers')}"
    return Unfit(reason, planner, 0.0)


class Numbering:
    """Gives the functions of a ground task numbers.

    An expression is a number as text, `["value", function]`, or an operator with two expressions.
    """

    def __init__(self) -> None:
        self._functions: dict[Words, int] = {}

    def comparison(self, atom: Atom) -> list[Any]:
        """A comparison: `["compare", operator, expression, expression]`."""
        left, right = sides(atom.arguments)
        return ["compare", atom.predicate, self._said(left), self._said(right)]

    def changes(
        self, actions: Sequence[Action], said: Callable[[Condition], list[Any]]
    ) -> list[list[Any]]:
        """What each action does to numbers: `[condition, kind, function, expression]`.

        Args:
            actions: The actions.
            said: How conditions are written.
        """
        return [
            [
                [said(c.condition), c.kind, self._number(c.function), self._said(c.by)]
                for c in action.changes
            ]
            for action in actions
        ]

    def values(self, state: State) -> list[str]:
        """What each function has for a value in a state.

        Raises:
            PDDLError: One has none.
        """
        known = values_in(state)
        missing = next((words for words in self._functions if words not in known), None)
        if missing is not None:
            said = f"({' '.join(missing)})"
            raise PDDLError(f"the state gives {said} no value; add (= {said} …)")
        return [written(known[words]) for words in self._functions]

    def _number(self, words: Words) -> int:
        return self._functions.setdefault(words, len(self._functions))

    def _said(self, expression: Expression) -> Any:
        if isinstance(expression, str):
            return written(number(expression))
        if expression[0] in ARITHMETIC:
            return [expression[0], *map(self._said, expression[1:])]
        return ["value", self._number(tuple(map(str, expression)))]
