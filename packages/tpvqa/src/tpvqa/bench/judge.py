"""Watches an episode beside the truth and counts what a report needs."""

from collections import Counter

from tpvqa.bench.truth import subject_of, yes_is_right
from tpvqa.episodes.events import Acted, Acting, Answered, Asked, Decided, Event, PlanMade
from tpvqa.episodes.events import QuestionRecord as Asking
from tpvqa.monitors import Decision
from tpvqa.pddl import Action
from tpvqa.worlds.simulation import Simulation


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
        self._asked: tuple[Asking, ...] = ()
        self._truths: list[bool] = []
        self.answers: Counter[str] = Counter()
        self.decisions: Counter[str] = Counter()
        self.longest_repeat = self.failures = self.wasted = 0
        self.first_plan: int | None = None

    def __call__(self, event: Event) -> None:
        """Take note of an event."""
        match event:
            case PlanMade() if self.first_plan is None:
                self.first_plan = len(event.plan)
            case Asked():
                self._asked = event.questions
                self._truths = [
                    yes_is_right(question, self._simulation, self._actions)
                    for question in event.questions
                ]
            case Answered():
                for question, truth, answer in zip(
                    self._asked, self._truths, event.answers, strict=True
                ):
                    p = "" if answer.p_yes is None else f"{answer.p_yes:.2f}"
                    key = f"{question.way}|{subject_of(question)}|{truth:d}|{answer.reply}|{p}"
                    self.answers[key] += 1
            case Decided():
                action = self._actions[event.action]
                if event.when == "before":
                    truth = self._simulation.possible(action)
                else:
                    truth = self._simulation.achieved(action)
                went_on = event.decision in (Decision.GO_ON, Decision.DONE)
                self.decisions[f"{event.when}|{truth:d}|{went_on:d}"] += 1
            case Acting():
                self.longest_repeat = max(self.longest_repeat, event.attempt)
            case Acted() if event.truth is not None:
                came = event.truth
                changed = bool(came["added"] or came["removed"])
                self.failures += not came["succeeded"] or came["undone"] is not None
                impossible = came["reason"] == "a precondition did not hold"
                self.wasted += impossible or (came["succeeded"] and not changed)
