"""Answers beside the truth, from trials in a simulated world as they run."""

from collections.abc import Callable, Iterable, Mapping

from tpvqa.belief import LabelledAnswer
from tpvqa.bench.cell import Cell
from tpvqa.bench.own_task import OwnTask
from tpvqa.bench.right_answers import yes_is_right
from tpvqa.bench.stage import stage, true_simulation
from tpvqa.config import TrialConfig
from tpvqa.events import Event, TrialState
from tpvqa.events.events import Answered, Asked, Observed, QuestionRecord
from tpvqa.labelling.recorded import subject_of, view_of
from tpvqa.pddl import Action
from tpvqa.worlds.simulation import Simulation


class Labeller:
    """A listener that keeps every answer of a VLM with what was true when it was asked.

    Args:
        simulation: The true state.
        actions: The task's ground actions, by their PDDL.
        trial: The trial's name among others.

    Attributes:
        rows: The answers so far.
    """

    def __init__(self, simulation: Simulation, actions: Mapping[str, Action], trial: str):
        self._simulation, self._actions, self._trial = simulation, actions, trial
        self._views: dict[int, str | None] = {}
        self._state = TrialState()
        self._truths: list[bool] = []
        self.rows: list[LabelledAnswer] = []

    def __call__(self, event: Event) -> None:
        """Take note of an event."""
        self._state = self._state.after(event)
        match event:
            case Observed():
                self._views[event.look] = view_of(event)
            case Asked():
                self._truths = [self._truth(question) for question in event.questions]
            case Answered():
                for (question, answer, look, person), truth in zip(
                    self._state.latest, self._truths, strict=True
                ):
                    if person:
                        continue
                    row = LabelledAnswer(
                        way=question.way,
                        predicate=subject_of(question),
                        text=question.text,
                        truth=truth,
                        reply=answer.reply,
                        p_yes=answer.p_yes,
                        trial=self._trial,
                        look=look,
                        view=self._views.get(look),
                    )
                    self.rows.append(row)

    def _truth(self, question: QuestionRecord) -> bool:
        return yes_is_right(question, self._simulation, self._actions)


def gather(
    cell: Cell,
    common: TrialConfig,
    episodes: Iterable[int],
    *,
    done: Callable[[], None] = lambda: None,
    own: OwnTask | None = None,
) -> list[LabelledAnswer]:
    """Run trials in a simulated world and label all their answers.

    Args:
        cell: The task, monitor, VLM and world.
        common: Seed, rates of faults, limits.
        episodes: Their numbers.
        done: Called after each.
        own: The task, where it is the user's own.

    Raises:
        TpvqaError: A trial cannot be run.
    """
    here, rows = stage(cell.task, own), []
    for episode in episodes:
        with here.trial(cell.config(common, episode)) as trial:
            labeller = Labeller(
                true_simulation(trial), here.actions, f"{cell}/{common.seed}/{episode}"
            )
            here.play(trial, labeller)
        rows += labeller.rows
        done()
    return rows
