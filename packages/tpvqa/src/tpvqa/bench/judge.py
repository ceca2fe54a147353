"""Watches an episode beside the truth and counts what a report needs."""

import re
from collections import Counter

from tpvqa.bench.right_answers import yes_is_right
from tpvqa.drivers import SteppingTrial
from tpvqa.events import Decision, Event, TrialState
from tpvqa.events.events import Acted, Acting, Answered, Asked, Decided
from tpvqa.labelling.recorded import subject_of
from tpvqa.pddl import Action
from tpvqa.worlds.outcome import Failure
from tpvqa.worlds.simulation import Simulation

CALLED_DEAD = re.compile(r"[^;]+ failed in about \d+ of \d+ tries(?:, of which[^;]*)?(;|$)")
"""How a monitor says first of all that a skill seems never to work."""


class Judge:
    """A listener of one episode in a simulated world.

    A question is judged by the true state at the moment it is asked; "possible" means that all
    preconditions hold then, "successful" that all effects do. A decision before an action is right
    if the robot goes on exactly where the action is possible, one after it if it goes on exactly
    where the action was successful.

    Args:
        simulation: The true state.
        actions: The task's ground actions, by their PDDL.
    """

    def __init__(self, simulation: Simulation, actions: dict[str, Action]):
        self._simulation, self._actions = simulation, actions
        self._trial: SteppingTrial | None = None
        self._truths: list[bool] = []
        self._possible = False
        self.answers: Counter[str] = Counter()
        self.decisions: Counter[str] = Counter()
        self.named: int | None = None
        self.misnamed: set[Action] = set()
        self.longest_repeat = self.failures = self.wasted = self.dead = 0

    @property
    def first_plan(self) -> int:
        """Actions of the first plan; 0 where there was none."""
        return self._state.first_plan or 0

    def watch(self, trial: SteppingTrial) -> None:
        """Name the trial whose events it is told of: where it stands is read there."""
        self._trial = trial

    @property
    def _state(self) -> TrialState:
        assert self._trial is not None
        return self._trial.state

    def __call__(self, event: Event) -> None:
        """Take note of an event."""
        match event:
            case Asked():
                self._truths = [
                    yes_is_right(question, self._simulation, self._actions)
                    for question in event.questions
                ]
            case Answered():
                for told, truth in zip(self._state.latest, self._truths, strict=True):
                    question, answer = told.question, told.answer
                    p = "" if answer.p_yes is None else f"{answer.p_yes:.2f}"
                    key = f"{question.way}|{subject_of(question)}|{truth:d}|{answer.reply}|{p}"
                    self.answers[key] += 1
            case Decided() if event.action:  # not of the look before the first plan
                action = self._actions[event.action]
                if event.when == "before":
                    truth = self._simulation.possible(action)
                else:
                    truth = self._simulation.achieved(action)
                if CALLED_DEAD.match(event.reason):
                    self._called_dead(action)
                went_on = event.decision in (Decision.GO_ON, Decision.DONE)
                self.decisions[f"{event.when}|{truth:d}|{went_on:d}"] += 1
            case Acting():
                self._possible = self._simulation.possible(self._actions[event.action.pddl()])
                self.longest_repeat = max(self.longest_repeat, event.attempt)
            case Acted() if event.truth is not None:
                came = event.truth
                changed = bool(came.added or came.removed)
                self.failures += not came.succeeded or came.undone is not None
                self.dead += came.failure is Failure.DEAD and self._possible
                impossible = came.failure is Failure.PRECONDITION
                self.wasted += impossible or (came.succeeded and not changed)

    def _called_dead(self, action: Action) -> None:
        if not self._simulation.dead.holds(action):
            self.misnamed.add(action)
        elif self.named is None:
            self.named = self.dead
