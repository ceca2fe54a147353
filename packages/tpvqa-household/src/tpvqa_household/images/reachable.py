"""Which visible states a task can lead to: all of these need pictures.

The closure of the initial true state under success of every action that a plan contains (from
any state of the closure, so also after disturbances; with either hand, and wherever the thing
then is), and under every disturbance of the world file. Failures without a disturbance change
nothing. Monitors that see badly plan from wrong beliefs; what they try is covered too, as long
as some plan from some true state contains it.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from tpvqa.errors import PictureSetError
from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.planning import Plan, Planner, Unsolvable
from tpvqa.worlds.world_file import WorldRules
from tpvqa_household.images.visible import VisibleState, visible_state

Kind = tuple[str, ...]
"""An action without its hands and without where it starts from: `("find", "plate")`."""

Places = tuple[tuple[str, Atom], ...]
"""Where each thing lay last: what a disturbance can put it back to."""


def kind(action: Action, task: Task) -> Kind:
    """What an action does, whatever hand does it and wherever it starts."""
    hands = task.objects_by_type.get("hand", ())
    arguments = [name for name in action.arguments if name not in hands]
    if action.name in ("find", "pick_up"):
        arguments = arguments[:1]
    return (action.name, *arguments)


def say_kind(of: Kind) -> str:
    """An action kind as the manifest writes it: `find(plate)`."""
    return f"{of[0]}({', '.join(of[1:])})"


@dataclass(frozen=True)
class Reachable:
    """The true states that a task can lead to, and how.

    Attributes:
        task: The task's name.
        states: All reachable true states.
        nominal: The kinds of action of the plan from the initial state, in order.
        steps: For every kind of action, the true states before and after each success.
        disturbed: For every true state, the states that a disturbance in it leads to.
    """

    task: str
    states: frozenset[State]
    nominal: tuple[Kind, ...]
    path: tuple[State, ...]
    steps: dict[Kind, frozenset[tuple[State, State]]] = field(repr=False)
    disturbed: dict[State, frozenset[State]] = field(repr=False)

    def classes(self) -> dict[VisibleState, list[State]]:
        """The true states by what the camera shows of them."""
        found: dict[VisibleState, list[State]] = defaultdict(list)
        for state in sorted(self.states, key=sorted):
            found[visible_state(state)].append(state)
        return dict(found)

    def after_success(self, of: Kind) -> frozenset[VisibleState]:
        """What can be seen after an action of this kind succeeded."""
        return frozenset(visible_state(after) for _, after in self.steps.get(of, ()))

    def after_failure(self, of: Kind) -> frozenset[VisibleState]:
        """What can be seen after it failed: nothing happened, or something was undone."""
        found = set()
        for before, _ in self.steps.get(of, ()):
            found |= {visible_state(s) for s in (before, *self.disturbed.get(before, ()))}
        return frozenset(found - self.after_success(of))


def reachable(task: Task, rules: WorldRules, planner: Planner, name: str) -> Reachable:
    """Enumerate what a task can lead to.

    Raises:
        PictureSetError: No plan was found from some reachable state in time.
    """
    plans: dict[State, tuple[Action, ...]] = {}

    def plan(state: State) -> tuple[Action, ...]:
        if state not in plans:
            result = planner.plan(task, state)
            if not isinstance(result, Plan | Unsolvable):
                raise PictureSetError(
                    f"{name}: no plan from {', '.join(a.pddl() for a in sorted(state))}: {result}"
                )
            plans[state] = result.actions if isinstance(result, Plan) else ()
        return plans[state]

    kinds: set[Kind] = set()
    by_kind: dict[Kind, list[Action]] = defaultdict(list)
    for action in task.ground_actions():
        by_kind[kind(action, task)].append(action)
    while True:
        known = len(kinds)
        found, steps, disturbed = _closure(task, rules, [a for k in kinds for a in by_kind[k]])
        for state in found:
            kinds |= {kind(action, task) for action in plan(state)}
        if len(kinds) == known:
            break
    path = [task.init]
    for action in plan(task.init):
        path.append(task.apply(path[-1], action))
    return Reachable(
        task=name,
        states=frozenset(found),
        nominal=tuple(kind(action, task) for action in plan(task.init)),
        path=tuple(path),
        steps={of: frozenset(steps_of) for of, steps_of in _grouped(steps, task).items()},
        disturbed=disturbed,
    )


def _grouped(
    steps: set[tuple[Action, State, State]], task: Task
) -> dict[Kind, set[tuple[State, State]]]:
    grouped: dict[Kind, set[tuple[State, State]]] = defaultdict(set)
    for action, before, after in steps:
        grouped[kind(action, task)].add((before, after))
    return grouped


def _closure(
    task: Task, rules: WorldRules, actions: Sequence[Action]
) -> tuple[set[State], set[tuple[Action, State, State]], dict[State, frozenset[State]]]:
    steps: set[tuple[Action, State, State]] = set()
    disturbed: dict[State, set[State]] = defaultdict(set)
    start: tuple[State, Places] = (task.init, ())
    seen, waiting = {start}, [start]
    while waiting:
        state, places = waiting.pop()
        following = []
        for action in actions:
            if task.applicable(state, action):
                after = task.apply(state, action)
                if after != state:
                    steps.add((action, state, after))
                    following.append(after)
        for after in _undone(task, rules, state, places):
            disturbed[state].add(after)
            following.append(after)
        for after in following:
            reached = (after, _places(places, state, after))
            if reached not in seen:
                seen.add(reached)
                waiting.append(reached)
    states = {state for state, _ in seen}
    return states, steps, {state: frozenset(found) for state, found in disturbed.items()}


def _undone(task: Task, rules: WorldRules, state: State, places: Places) -> Iterator[State]:
    history = [atom for _, atom in places]
    for atom in sorted(state - task.init):
        for rule in rules.undo:
            for _, after in rule.results(atom, state, history, task):
                yield after


def _places(places: Places, before: State, after: State) -> Places:
    latest = dict(places)
    for atom in before - after:
        if atom.predicate == "on":
            latest[atom.arguments[0]] = atom
    return tuple(sorted(latest.items()))
