"""A plan with what each of its steps needs: where in it a state stands.

As PLANEX did with triangle tables (Fikes, Hart and Nilsson 1972): the plan can be gone on with from
its latest step whose needs hold, however the state came about. Needs are regressed through the
rest of the plan (Fritz and McIlraith 2007).
"""

from collections.abc import Iterable, Sequence

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
        self._bits = {atom: 1 << number for number, atom in enumerate(sorted(self._atoms))}
        self._wanted = [(self._mask(need, True), self._mask(need, False)) for need in needs]

    def _mask(self, need: Needs, positive: bool) -> int:
        return sum(self._bits[each.atom] for each in need if each.positive is positive)

    def place(self, state: State) -> int | None:
        """The latest step from which on the plan reaches the goal; its length for the goal.

        None where the plan cannot be gone on with from the state.
        """
        if self.task.goal_holds(state):
            return len(self.actions)
        bits = self._bits
        full = sum(bits[atom] for atom in self.task.extend(state) if atom in bits)
        for index in range(len(self._wanted) - 1, -1, -1):
            holding, not_holding = self._wanted[index]
            if not (holding & ~full or not_holding & full):
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
