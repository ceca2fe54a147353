"""Which objects may matter for a plan: backward from the goal, on the task with its variables.

What the goal lacks is traced through the effects of actions to their preconditions, those with
the objects that make static facts and, where possible, facts of the state hold. So an alternating
graph comes about of facts that are needed and instances of actions that support them, each
estimated as if nothing were ever undone (Bonet and Geffner 2001); the cheapest support is taken
(as Hoffmann and Nebel 2001 do on ground tasks), and its objects matter. This is a guess: who
plans with them alone has to see whether the plan holds in the whole task, and to take more
objects where there is none.
"""

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from heapq import heappop, heappush
from itertools import count

from tpvqa.pddl.worker.grounding import AtomKey
from tpvqa.pddl.worker.matching import Binding, Matcher, unified
from tpvqa.pddl.worker.rules import Literal, Rule, Rules

_LEAST = 50
"""So many needs are traced at least to see how what is undone can be brought about again."""
_FEW = 16
"""So many supports are looked at first, and further ones later."""
_INFERENCE = 0.01
"""What a step costs that is no action; more than nothing, so that no facts support each other."""


@dataclass(frozen=True, slots=True)
class Effort:
    """How far is looked.

    Attributes:
        needs: So many needed facts are traced.
        supports: So many instances of a rule are taken for one of them.
        spare: So many facts of an instance that hold for some objects are also brought about for
            others.
        slack: Supports that are dearer than the cheapest by so many times its cost matter, too.
    """

    needs: int
    supports: int
    spare: int
    slack: float


EFFORTS = (
    Effort(needs=3000, supports=128, spare=2, slack=0),
    Effort(needs=4000, supports=128, spare=2, slack=0.5),
    Effort(needs=5000, supports=192, spare=2, slack=math.inf),
)
"""From the least to the most; what none of these finds, the whole task decides."""


@dataclass(slots=True)
class _Support:
    rule: Rule | None
    binding: Binding
    needs: list["_Need"]
    own_cost: float


@dataclass(slots=True, eq=False)
class _Need:
    literal: Literal | None
    cost: float = math.inf
    far: float = 0
    supports: list[_Support] = field(default_factory=list)
    known: set[tuple[str, ...]] = field(default_factory=set)
    looked: bool = False
    users: list["_Need"] = field(default_factory=list)


def relevant_objects(
    rules: Rules, state: frozenset[AtomKey], effort: Effort
) -> frozenset[str] | None:
    """The objects that may matter for reaching the goal.

    Args:
        rules: The task.
        state: The atoms that hold, static ones included.
        effort: How far is looked.

    Returns:
        The objects, or None where no way to the goal was found so far.
    """
    graph = _Graph(rules, state, effort)
    goals = [graph.need(literal) for literal in rules.goal]
    done = graph.trace(goals, effort.needs)
    if any(math.isinf(goal.cost) for goal in goals):
        return None
    chosen = graph.chosen(goals)
    # What the way there undoes of what it needs is to be brought about again.
    again = [graph.anew(literal) for literal in _undone(rules.goal, chosen)]
    if again:
        graph.trace(again, max(done, _LEAST))
        chosen += graph.chosen(again)
    objects = set(rules.named)
    for support in chosen:
        objects.update(support.binding.values())
    # Two hands may be needed at once though each alone could do whatever either does.
    return frozenset(objects).union(*(rules.alike.get(name, ()) for name in objects))


class _Graph:
    def __init__(self, rules: Rules, state: frozenset[AtomKey], effort: Effort):
        self._rules, self._effort = rules, effort
        self._matcher = Matcher(rules, state)
        self._needs: dict[Literal, _Need] = {}
        self._waiting: list[tuple[float, int, _Need]] = []
        self._numbers = count()

    def need(self, literal: Literal, far: float = 0) -> _Need:
        """The node of a needed literal, which waits to be traced unless it holds."""
        node = self._needs.get(literal)
        if node is None:
            if self._matcher.holds(literal):
                node = _Need(literal, cost=0)
            else:
                node = self.anew(literal, far)
            self._needs[literal] = node
        return node

    def anew(self, literal: Literal, far: float = 0) -> _Need:
        """A node for bringing a literal about, whether it holds now or not."""
        node = _Need(literal, far=far)
        heappush(self._waiting, (far, next(self._numbers), node))
        return node

    def trace(self, goals: Iterable[_Need], most: int) -> int:
        """Trace what waits, nearest to the goal first, until the goals can be reached.

        With some slack it goes on for as long again.

        Returns:
            How many needs were traced; at most so many are.
        """
        open_goals, done, enough = list(goals), 0, most
        while self._waiting and done < enough:
            if open_goals:
                open_goals = [goal for goal in open_goals if math.isinf(goal.cost)]
                if not open_goals:
                    enough = min(enough, 2 * done if self._effort.slack else done)
                    continue
            self._expand(heappop(self._waiting)[2])
            done += 1
        return done

    def _expand(self, node: _Need) -> None:
        literal = node.literal
        assert literal is not None
        if literal.predicate in self._rules.derived and not literal.positive:
            self._prevent(node, literal)
        elif self._support(node, literal, self._effort.supports if node.looked else _FEW):
            later = node.far + math.log2(_FEW)
            heappush(self._waiting, (later, next(self._numbers), node))
        node.looked = True
        self._settle(node)

    def _support(self, node: _Need, literal: Literal, most: int) -> bool:
        """Adds what brings a literal about, so much a rule; whether there may be more."""
        more = False
        for number, rule in enumerate(
            self._rules.by_head.get((literal.positive, literal.predicate), ())
        ):
            binding = unified(rule, literal)
            if binding is None:
                continue
            supports = self._matcher.supports(rule, binding, spare=self._effort.spare, most=most)
            more |= len(supports) == most < self._effort.supports
            for rank, (found, missing) in enumerate(supports):
                key = (str(number), *(found[word] for word in rule.variables))
                if key in node.known:
                    continue
                node.known.add(key)
                self._matcher.preferred.update(dict.fromkeys(found.values()))
                far = node.far + 1 + math.log2(1 + rank)
                needs = [self.need(each, far) for each in missing]
                self._add(node, _Support(rule, found, needs, self._price(rule, found)))
        return more

    def _price(self, rule: Rule, binding: Binding) -> float:
        if rule.derives:
            return _INFERENCE
        if not isinstance(rule.price, tuple):
            return 1 + rule.price
        return 1 + self._rules.prices.get(tuple(binding.get(w, w) for w in rule.price), 0)

    def _prevent(self, node: _Need, literal: Literal) -> None:
        """A derived fact is kept from holding by ending one condition of each of its reasons."""
        ends: list[_Need] = []
        binding: Binding = {}
        for rule, found in self._matcher.reasons(literal.negate()):
            binding |= {f"{word} {len(ends)}": name for word, name in found.items()}
            end = _Need(None)
            for each in rule.body:
                if each.predicate not in self._rules.static:
                    opposite = self.need(each.bound(found).negate(), node.far)
                    self._add(end, _Support(None, {}, [opposite], _INFERENCE))
            self._settle(end)
            ends.append(end)
            if len(ends) > self._effort.supports:
                break
        self._add(node, _Support(None, binding, ends, _INFERENCE))

    def _add(self, node: _Need, support: _Support) -> None:
        node.supports.append(support)
        for each in support.needs:
            each.users.append(node)

    def _settle(self, node: _Need) -> None:
        """Lower costs, as far as a new support does."""
        open_nodes = deque([node])
        while open_nodes:
            each = open_nodes.popleft()
            cost = min(map(_cost, each.supports), default=math.inf)
            if cost < each.cost:
                each.cost = cost
                open_nodes.extend(each.users)

    def chosen(self, goals: Iterable[_Need]) -> list[_Support]:
        """The supports on the cheapest ways to the goals, and those within the slack of them."""
        found: list[_Support] = []
        names: set[str] = set()
        waiting, seen = deque(goals), set(goals)
        while waiting:
            node = waiting.popleft()
            if not node.supports or math.isinf(node.cost):
                continue
            priced = [(_cost(each), each) for each in node.supports]
            least = min(cost for cost, _ in priced)
            within = [
                each
                for cost, each in priced
                if cost < math.inf and cost <= least + self._effort.slack * max(1, least)
            ]
            if not self._effort.slack:
                within = [min(within, key=lambda each: len(set(each.binding.values()) - names))]
            for support in within:
                found.append(support)
                names.update(support.binding.values())
                for each in support.needs:
                    if each not in seen:
                        seen.add(each)
                        waiting.append(each)
        return found


def _cost(support: _Support) -> float:
    return support.own_cost + sum(need.cost for need in support.needs)


def _undone(goal: Iterable[Literal], chosen: Iterable[_Support]) -> list[Literal]:
    """What is needed on the way and ended by an action that is not the only one to need it."""
    needed: dict[Literal, set[int]] = {literal: {-1} for literal in goal}
    ended: dict[Literal, set[int]] = {}
    for number, support in enumerate(chosen):
        if support.rule is not None:
            changes = {each.bound(support.binding) for each in support.rule.changes}
            for literal in support.rule.body:
                needed.setdefault(literal.bound(support.binding), set()).add(number)
            for literal in changes:
                if literal.negate() not in changes:
                    ended.setdefault(literal.negate(), set()).add(number)
    return [
        literal
        for literal, users in needed.items()
        if any(users - {number} for number in ended.get(literal, ()))
    ]
