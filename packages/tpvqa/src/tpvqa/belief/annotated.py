"""A plan with what each of its steps needs: where in it a state stands.

As PLANEX did with triangle tables (Fikes, Hart and Nilsson 1972): the plan can be gone on with from
its latest step whose needs hold, however the state came about. Needs are regressed through the
rest of the plan (Fritz and McIlraith 2007).
"""

from collections.abc import Callable, Iterable, Sequence

from tpvqa.pddl import Action, Atom, Literal, State, Task, literals

Needs = frozenset[Literal]


class AnnotatedPlan:
    """A plan and, for each of its steps and for the goal, the literals that it needs.

    Args:
        task: The task.
        actions: The actions of the plan.
        needs: One set of literals per step and one for the goal, see
            `planning.regression.regress`.
    """

    def __init__(self, task: Task, actions: Sequence[Action], needs: Sequence[Needs]):
        self.task, self.actions, self.needs = task, tuple(actions), tuple(needs)
        self._atoms = frozenset(each.atom for need in needs for each in need)

    def wanted(self, bits: Callable[[Iterable[Atom]], int]) -> "Wanted":
        """What every step and the goal need, as bits of facts."""
        return Wanted(self.needs, bits)

    def place(self, state: State) -> int | None:
        """The latest step from which on the plan reaches the goal; its length for the goal.

        None where the plan cannot be gone on with from the state.
        """
        if self.task.goal_holds(state):
            return len(self.actions)
        full = self.task.extend(state)
        for index in range(len(self.needs) - 1, -1, -1):
            if all((each.atom in full) is each.positive for each in self.needs[index]):
                return index
        return None

    def remaining(self, state: State) -> int | None:
        """How many actions are left from a state; None where the plan does not help."""
        place = self.place(state)
        return None if place is None else len(self.actions) - place

    def atoms(self, first: int = 0) -> frozenset[Atom]:
        """The facts that the plan needs from a step on, goal included."""
        if not first:
            return self._atoms
        return frozenset(each.atom for need in self.needs[first:] for each in need)

    def needing(self, atom: Atom, first: int = 0) -> int | None:
        """The first step from a given one whose action itself rests on a fact.

        The plan's length stands for the goal; None where the rest of the plan does not need it.
        """
        for index in range(first, len(self.needs)):
            if index == len(self.actions):
                resting: Iterable[Literal] = self.needs[index]
            else:
                resting = literals(self.actions[index].precondition)
            if any(each.atom == atom for each in resting):
                return index
        return None


class Wanted:
    """What the steps of a plan and the goal need, as bits of facts, to find a place in it fast.

    A fact is needed by steps one after the other. Where it is not as it has to be, none of them
    can be gone on with.

    Args:
        needs: Of every step and the goal.
        bits: Facts as bits of a number.
    """

    def __init__(self, needs: Sequence[Needs], bits: Callable[[Iterable[Atom]], int]):
        self._steps: list[tuple[int, int, dict[int, int], dict[int, int]]] = []
        since: dict[Literal, int] = {}
        for index, need in enumerate(needs):
            since = {each: since.get(each, index) for each in need}
            needed, barred = dict[int, int](), dict[int, int]()
            for each, first in since.items():
                (needed if each.positive else barred)[bits((each.atom,))] = first
            self._steps.append((sum(needed), sum(barred), needed, barred))

    def latest(self, holding: int) -> int | None:
        """The latest step whose needs are met where some facts hold; None where none is."""
        lacking, index = ~holding, len(self._steps) - 1
        while index >= 0:
            needed, barred, needed_since, barred_since = self._steps[index]
            if missing := needed & lacking:  # the lowest bit is that of what is needed first
                index = needed_since[missing & -missing] - 1
            elif wrong := barred & holding:
                index = barred_since[wrong & -wrong] - 1
            else:
                return index
        return None
