"""A plan regressed to what each of its steps, and all later ones, need."""

from collections.abc import Iterable, Mapping, Sequence

from tpvqa.errors import PlannerError
from tpvqa.pddl import Action, Condition, Conjunction, Disjunction, Literal, State, Task, holds
from tpvqa.pddl.validation import validate

Needs = frozenset[Literal]


def regress(task: Task, actions: Sequence[Action], state: State | None = None) -> tuple[Needs, ...]:
    """What has to hold before each step so that the rest of the plan reaches the goal.

    Where a condition leaves a choice (a disjunction), the part that holds on the way from `state`
    is taken. Facts that no action changes are left out, derived ones are traced to what they
    follow from.

    Args:
        task: The task.
        actions: A plan that is valid from the state.
        state: Where the plan starts (the task's initial state by default).

    Returns:
        One set of literals per step and one for the goal. In every state in which all literals of
        entry *i* hold (static facts being equal), the actions from number *i* on reach the goal.

    Raises:
        PlannerError: The plan is not valid from the state.
    """
    replay = validate(task, actions, state)
    if not replay.valid:
        raise PlannerError(f"only a valid plan can be regressed; {replay}")
    result = [_Support(task, replay.states[-1]).of(task.goal)]
    for action, before in zip(reversed(actions), reversed(replay.states[:-1]), strict=True):
        support = _Support(task, before)
        conditions: dict[Literal, list[Condition]] = {}
        for effect in action.effects:
            conditions.setdefault(effect.literal, []).append(effect.condition)
        needs = set(support.of(action.precondition))
        touched = {literal.atom for literal in conditions}
        for literal in result[-1]:
            if literal.atom in touched:
                needs |= _before(literal, conditions, support)
            else:
                needs.add(literal)
        result.append(frozenset(needs))
    return tuple(reversed(result))


class _Support:
    """Chooses literals on which a condition rests in a state."""

    def __init__(self, task: Task, state: State):
        self._task, self._state, self._full = task, state, task.extend(state)

    def holds(self, condition: Condition) -> bool:
        return holds(condition, self._full)

    def of(self, condition: Condition) -> Needs:
        """Literals that hold in the state and imply the condition, which holds in it."""
        match condition:
            case Literal(atom):
                if atom.predicate in self._task.derived:
                    return self._changing(
                        self._task.derivation(self._state).explain(condition, self._state)
                    )
                return self._changing([condition])
            case Conjunction(parts):
                return frozenset().union(*map(self.of, parts))
            case Disjunction(parts):
                return min((self.of(part) for part in parts if self.holds(part)), key=len)

    def of_none(self, conditions: Iterable[Condition]) -> Needs:
        """Literals that imply that none of the conditions holds, as none does in the state."""
        return frozenset().union(*(self.of(_negated(condition)) for condition in conditions))

    def _changing(self, literals: Iterable[Literal]) -> Needs:
        return frozenset(part for part in literals if part.atom.predicate in self._task.fluents)


def _before(
    literal: Literal, conditions: Mapping[Literal, Sequence[Condition]], support: _Support
) -> Needs:
    """What has to hold before an action for a literal to hold after it.

    `conditions` are those under which each literal is an effect of the action.
    """
    adds, deletes = (
        conditions.get(Literal(literal.atom, positive), ()) for positive in (True, False)
    )
    causes = adds if literal.positive else deletes
    ways = [support.of(condition) for condition in causes if support.holds(condition)]
    if support.holds(literal):
        # It held before and nothing ended it; what is both added and deleted holds.
        ends = deletes if literal.positive else ()
        if not any(support.holds(condition) for condition in ends):
            ways.append(support.of(literal) | support.of_none(ends))
    chosen = min(ways, key=len)
    return chosen if literal.positive else chosen | support.of_none(adds)


def _negated(condition: Condition) -> Condition:
    match condition:
        case Literal():
            return condition.negate()
        case Conjunction(parts):
            return Disjunction(tuple(map(_negated, parts)))
        case Disjunction(parts):
            return Conjunction(tuple(map(_negated, parts)))
