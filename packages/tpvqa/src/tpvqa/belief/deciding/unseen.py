"""What it costs to go on without seeing: one way is followed whatever is true.

Q-MDP takes all to be known after the next action. Where the answers that can be had do not settle a
doubt, that is not so; a plan is then worth what it does unseen, every step repeated so often as the
risk that is left is worth another time, and perhaps another plan after it. That is worked out
backward from the end, in every joint state, in the belief's own model.
"""

from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.deciding.improving import Improving
from tpvqa.belief.deciding.long_rests import HORIZON, TIMES, LongRests
from tpvqa.belief.deciding.one_thread import one_thread
from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.deciding.steps import Steps
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.pddl import Action, State

Way = tuple[int, AnnotatedPlan]
"""A place in a plan, and that plan."""
Led = tuple[float, Sequence[tuple[float, int, float]]]
"""The probability of a joint state, and what an action leads to from it: shares, joint states, and
what each costs besides."""
_Costs = tuple[Floats, Floats]
"""What something costs from every joint state, and with its first step once less."""
Tails = dict[tuple[object, tuple[Action, ...]], _Costs]
"""What the last steps of ways cost, by what follows them and by the steps: ways that end alike
share them."""
WAYS = 4
"""Ways that are compared, those of the most probable joint states, besides ending."""
ENDINGS = 3
"""What may come after a way: the end, or one of the two best ways."""
BEST = 5
"""Ways to go on that are told of an action, those that are expected to cost least."""
KEEPING = 1.0
"""By how many actions something else has to be better than what is being followed."""
STAKES = 1.25
"""What is followed is decided anew where a failed task costs so many times as much as then."""


class _Sequence(NamedTuple):
    """To end, where there is no way; or a way with each step repeated, and what follows it.

    Attributes:
        way: Its number among those compared; None to end.
        times: How often each step is done.
        then: What follows; None for the end.
    """

    way: int | None
    times: int = 0
    then: "_Sequence | None" = None


class _Onward(NamedTuple):
    """What comes after an action.

    Attributes:
        actions: What is followed.
        rest: What is meant to come after that, where it is too long to be followed.
        begins: Where in a plan that rest begins; None where there is none.
    """

    actions: tuple[Action, ...]
    rest: tuple[Action, ...]
    begins: Way | None = None


class Unseen:
    """What ways cost that are followed without a look.

    Args:
        model: The action model.
        ahead: The cheapest ways from single joint states.
        costs: What things cost.

    Attributes:
        following: The actions that were decided for and are not done yet.
        onward: Those that are meant to come after them, where that is too long to be followed.
    """

    def __init__(self, model: FaultModel, ahead: Outlook, costs: Costs):
        self._model, self._ahead, self._costs = model, ahead, costs
        self._steps = Steps(model)
        self._rests = LongRests(model, ahead, costs)
        self._known: dict[tuple[int, int, object], list[_Costs]] = {}
        self._worked_out_for: tuple[int, int] = (-1, -1)
        self.following: tuple[Action, ...] = ()
        self.onward: tuple[Action, ...] = ()
        self._stake = 0.0
        self._ways_told: list[tuple[Action, ...]] = []
        self._after: dict[Action, _Onward] = {}

    def renumbered(self, model: FaultModel) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model, self._steps = model, Steps(model)
        self._rests.renumbered(model)
        self._known.clear()

    def acted(self, action: Action, state: State) -> None:
        """Note that an action is executed, where a state is most probable."""
        follows = self.following and self._model.same_skill(self.following[0], action, state)
        self.following = self.following[1:] if follows else ()

    def follow(self, action: Action) -> None:
        """Decide for an action, with what is best to come after it."""
        after = self._after.get(action)
        self.following, self.onward = (action,), ()
        if after is not None:
            self.following, self.onward = (action, *after.actions), after.rest
        self._stake = self._ahead.failure

    def improve(self, ranked: Sequence[tuple[int, float]]) -> None:
        """Follow something better than was decided for, where there is such: no answer will tell
        how it goes.

        Args:
            ranked: All joint states with their probabilities.
        """
        onward = self._after.get(self.following[0])
        if onward is None:
            return
        after = self._ended()
        if onward.begins is not None:
            place, plan = onward.begins
            after = self._rests.of(plan, place, self._steps.numbers)
        masses = np.zeros(len(self._steps.numbers) + 1)
        for number, mass in ranked:
            masses[self._steps.place.get(number, -1)] += mass
        left = None if self._ahead.left is None else self._ahead.left - len(self.onward)
        better = Improving(self._steps, self._ahead, self._costs.action).improved(
            self.following, self._ways_told, masses, after, left
        )
        self.following = better or self.following

    def drop(self) -> None:
        """Follow nothing any more."""
        self.following = self.onward = ()

    def skip(self) -> None:
        """Leave out the action that comes next: it cannot be done."""
        self.following = self.following[1:]

    @property
    def more_at_stake(self) -> bool:
        """Whether a failed task costs much more than when it was decided what to follow."""
        return self._ahead.failure >= STAKES * self._stake

    @one_thread
    def columns(
        self,
        actions: Sequence[tuple[Action, Sequence[Led]]],
        ranked: Sequence[tuple[int, float]],
    ) -> dict[Action, list[Floats]]:
        """The expected costs of actions in the joint states, for the best ways to go on.

        What is best to do need not be the next step of anybody's plan: such actions are told, too.

        Args:
            actions: Each with the probabilities of the most probable joint states and what it
                leads to from them.
            ranked: All joint states with their probabilities, the most probable first; where the
                actions do not say what they lead to, the task fails.
        """
        masses, ways = self._prepared(actions, ranked)
        told, begun, less = self._worked_out(ways, masses)
        self._after = {}
        found: dict[Action, list[Floats]] = {}
        for action, led in actions:
            own = begun.copy()
            for column, each in enumerate(told):
                if each.way is not None and self._first(ways, each) == action:
                    own[:, column] = less[:, column]
            paid = self._costs.action + self._led_to(led, own)
            weights = np.array([weight for weight, _ in led])
            best = np.argsort(np.round(weights @ paid, 9), kind="stable")[:BEST].tolist()
            found[action] = [self._whole(paid[:, n], ranked) for n in dict.fromkeys([0, *best])]
            self._after[action] = self._parted(ways, told[best[0]], action)
        led_states = ranked[: len(actions[0][1])]
        here = begun[self._steps.places([number for number, _ in led_states])]
        expected = np.array([weight for _, weight in led_states]) @ here
        for column in np.argsort(np.round(expected, 9), kind="stable")[:BEST].tolist():
            if told[column].way is None:
                break
            first = self._first(ways, told[column])
            if first not in found:
                found[first] = [self._whole(here[:, column], ranked)]
                self._after[first] = self._parted(ways, told[column], first)
        if self.following and not self.onward:
            left = self._ended()[:, None]
            for action in reversed(self.following):
                left = self._costs.action + self._back(action, left)
            kept = left[self._steps.places([number for number, _ in led_states]), 0]
            kept = kept - KEEPING * self._costs.action
            first, *rest = self.following
            found.setdefault(first, []).append(self._whole(np.maximum(kept, 0.0), ranked))
            self._after[first] = _Onward(tuple(rest), ())
        return found

    def _prepared(
        self,
        actions: Sequence[tuple[Action, Sequence[Led]]],
        ranked: Sequence[tuple[int, float]],
    ) -> tuple[dict[int, float], list[Way]]:
        """What is predicted, and the ways to compare. What was worked out before is forgotten where
        it does not hold any more."""
        masses = dict(ranked[: len(actions[0][1])])
        for _, led in actions:
            for weight, after in led:
                for share, other, _ in after:
                    masses[other] = masses.get(other, 0.0) + weight * share / len(actions)
        ways = self._ways(masses.items(), [action for action, _ in actions])
        told, cut = list[tuple[Action, ...]](), list[tuple[Action, ...]]()
        for place, plan in ways:
            long = len(plan.actions) - place > HORIZON
            (cut if long else told).append(tuple(plan.actions[place : place + HORIZON]))
        self._ways_told = told
        once = tuple(action for action, _ in groupby(self.following))
        self._steps.cover(masses, told, self._ahead.rates, cut=cut, followed=once)
        version = self._ahead.version, self._steps.version
        if version != self._worked_out_for:
            self._worked_out_for = version
            self._known.clear()
            self._rests.forget(self._ahead.plans)
        return masses, ways

    def _ways(self, predicted: Iterable[tuple[int, float]], actions: Sequence[Action]) -> list[Way]:
        """Those of the most probable joint states, and what comes next on them after an action."""
        masses: dict[Way, float] = {}
        for number, mass in predicted:
            way = self._ahead.best(number)
            if way is not None and way[0] < len(way[1].actions):
                masses[way] = masses.get(way, 0.0) + mass
        found = sorted(masses, key=lambda way: -masses[way])[:WAYS]
        for place, plan in list(found):
            if plan.actions[place] in actions and place + 1 < len(plan.actions):
                found.append((place + 1, plan))
        return list(dict.fromkeys(found))

    def _worked_out(
        self, ways: Sequence[Way], masses: Mapping[int, float]
    ) -> tuple[list[_Sequence], Floats, Floats]:
        """What can be done, and what each costs from every joint state (rows); and the same with
        its first step once less."""
        places, whole = self._steps.places(masses), np.array(list(masses.values()))
        ended = self._ended()[:, None]
        numbered = [(number, times) for number in range(len(ways)) for times in TIMES]
        told = [_Sequence(None), *(_Sequence(*each) for each in numbered)]
        tails: Tails = {}
        once = [each for way in ways for each in self._followed(way, ended, None, tails)]
        costs = [float(whole @ begun[places, 0]) for begun, _ in once]
        best = sorted(range(len(once)), key=lambda each: round(costs[each], 9))[: ENDINGS - 1]
        parts = [(ended, ended), *once]
        if best:
            seconds = np.concatenate([once[each][0] for each in best], axis=1)
            then = tuple(told[1 + each] for each in best)
            which = tuple((*ways[n], times) for n, times in (numbered[each] for each in best))
            for way in ways:
                parts += self._followed(way, seconds, which, tails)
            for number, times in numbered:
                told += [_Sequence(number, times, each) for each in then]
        begun, less = (np.concatenate([each[side] for each in parts], axis=1) for side in (0, 1))
        if self._ahead.left is not None:
            over = np.array([self._takes(ways, each) for each in told]) > self._ahead.left
            begun[:, over] = less[:, over] = self._ahead.failure + self._costs.action
        return told, begun, less

    def _takes(self, ways: Sequence[Way], each: _Sequence) -> int:
        """How many actions are done in all."""
        if each.way is None:
            return 0
        place, plan = ways[each.way]
        stop = min(place + HORIZON, len(plan.actions))
        done = (stop - place) * each.times
        if stop < len(plan.actions):
            return done + (len(plan.actions) - stop) * self._rests.repeated(plan, stop)
        return done if each.then is None else done + self._takes(ways, each.then)

    def _followed(self, way: Way, after: Floats, then: object, tails: Tails) -> list[_Costs]:
        """What a way costs from every joint state, each step done each of `TIMES`, by what is left
        to pay after it; and with its first step once less."""
        place, plan = way
        key = place, id(plan), then
        known = self._known.get(key)
        if known is not None:
            return known
        steps, wide = plan.actions[place : place + HORIZON], after.shape[1]
        stop = place + len(steps)
        if stop < len(plan.actions):  # whatever follows, its rest comes first
            after = self._rests.of(plan, stop, self._steps.numbers)[:, None]
            then = id(plan), stop
        values, before = self._before(steps, after, then, tails)
        parts = np.hsplit(values, len(TIMES)), np.hsplit(before, len(TIMES))
        found = list(zip(*parts, strict=True))[::-1]
        if after.shape[1] < wide:
            found = [(np.repeat(v, wide, axis=1), np.repeat(b, wide, axis=1)) for v, b in found]
        self._known[key] = found
        return found

    def _before(
        self, steps: tuple[Action, ...], after: Floats, then: object, tails: Tails
    ) -> _Costs:
        """What is left to pay before some steps; side by side, the most often done first."""
        wide = after.shape[1]
        first = next((n for n in range(len(steps)) if (then, steps[n:]) in tails), len(steps))
        values, before = tails.get((then, steps[first:])) or (np.tile(after, len(TIMES)),) * 2
        for step in range(first - 1, -1, -1):
            values, before = values.copy(), values.copy()
            for often in range(1, TIMES[-1] + 1):
                these = slice(0, wide * sum(times >= often for times in TIMES))
                before[:, these] = values[:, these]
                values[:, these] = self._costs.action + self._back(steps[step], values[:, these])
            tails[then, steps[step:]] = values, before
        return values, before

    def _back(self, action: Action, after: Floats) -> Floats:
        ahead = self._ahead
        return self._steps.back(action, after, ahead.skill(action).failure, ahead.rates)

    def _ended(self) -> Floats:
        """What it costs to end in each joint state."""
        lost = self._ahead.failure
        goals = [0.0 if self._ahead.is_goal(n) else lost for n in self._steps.numbers]
        return np.array([*goals, lost])

    def _led_to(self, led: Sequence[Led], values: Floats) -> Floats:
        """The expectation of something after an action, in the joint states before it."""
        leads, more = np.zeros((len(led), len(values))), np.zeros(len(led))
        for row, (_, after) in enumerate(led):
            for share, other, besides in after:
                leads[row, self._steps.place[other]] += share
                more[row] += share * besides
        found: Floats = leads @ values + more[:, None]
        return found

    def _whole(self, first: Floats, ranked: Sequence[tuple[int, float]]) -> Floats:
        """Costs in all joint states, by those in the first of them."""
        found = np.full(len(ranked), self._ahead.failure)
        found[: len(first)] = first
        return found

    def _first(self, ways: Sequence[Way], each: _Sequence) -> Action:
        assert each.way is not None
        place, plan = ways[each.way]
        return plan.actions[place]

    def _parted(self, ways: Sequence[Way], each: _Sequence, done: Action) -> _Onward:
        """The actions of something that can be done, after the first, where that is one of them."""
        found: list[Action] = []
        part: _Sequence | None = each
        cut: int | None = None
        begins: Way | None = None
        while part is not None and part.way is not None:
            place, plan = ways[part.way]
            if cut is None and len(plan.actions) - place > HORIZON:
                cut = len(found) + HORIZON * part.times
                begins = place + HORIZON, plan
            found += [action for action in plan.actions[place:] for _ in range(part.times)]
            part = part.then
        begun = found[:1] == [done]
        cut = len(found) if cut is None else cut
        return _Onward(tuple(found[begun:cut]), tuple(found[cut:]), begins)
