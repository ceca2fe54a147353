"""Answers beside the truth, from trials in a simulated world as they run."""

from collections.abc import Callable, Iterable, Mapping, Sequence

from tpvqa.belief import LabelledAnswer
from tpvqa.belief.calibrating.counted import Came, LabelledAct
from tpvqa.belief.calibrating.own_words import LabelledReading, LabelledReport, OwnWords
from tpvqa.bench.cell import Cell
from tpvqa.bench.own_task import OwnTask
from tpvqa.bench.right_answers import yes_is_right
from tpvqa.bench.stage import stage, true_simulation
from tpvqa.config import TrialConfig
from tpvqa.events import Event, TrialState
from tpvqa.events.events import (
    Acted,
    Acting,
    Answered,
    Asked,
    Observed,
    QuestionRecord,
    SensedRecord,
)
from tpvqa.labelling.recorded import subject_of, view_of
from tpvqa.pddl import Action, Atom, State
from tpvqa.pddl.atoms import holds_in
from tpvqa.worlds import Report
from tpvqa.worlds.outcome import Failure
from tpvqa.worlds.simulation import BY_SOMEBODY, Simulation

_CAME = {
    None: Came.SUCCESS,
    Failure.PRECONDITION: Came.IMPOSSIBLE,
    Failure.CHANCE: Came.FAILURE,
    Failure.SCRIPT: Came.FAILURE,
}


class Labeller:
    """A listener that keeps every answer of a VLM with what was true when it was asked, and what
    the robot itself said with what was true then.

    Args:
        simulation: The true state.
        actions: The task's ground actions, by their PDDL.
        trial: The trial's name among others.

    Attributes:
        rows: The answers so far.
        own: What the robot itself said so far; of a fact once between two actions.
    """

    def __init__(self, simulation: Simulation, actions: Mapping[str, Action], trial: str):
        self._simulation, self._actions, self._trial = simulation, actions, trial
        self._views: dict[int, str | None] = {}
        self._state = TrialState()
        self._truths: list[bool] = []
        self._acting: Action | None = None
        self._idle, self._undoable = False, False
        # Numbers drift, and while actions last much else changes what holds.
        self._tells_undone = not simulation.rules.numbers and simulation.task.lasting is None
        self.rows: list[LabelledAnswer] = []
        self.own = OwnWords()
        self._read: set[str] = set()
        self._scenes: dict[State, int] = {}

    def __call__(self, event: Event) -> None:
        """Take note of an event."""
        self._state = self._state.after(event)
        match event:
            case Observed():
                self._views[event.look] = view_of(event)
                if not event.during:
                    self._sense(event.facts)
            case Acting():
                self._acting = action = self._actions[event.action.pddl()]
                self._idle = self._simulation.achieved(action)
                self._undoable = self._could_come_undone()
            case Acted():
                self._read.clear()
                self._sense(event.facts)
                self._report(event)
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
                        scene=self._scene(),
                    )
                    self.rows.append(row)

    def _scene(self) -> str:
        """The number of the true state among those of the trial."""
        return str(self._scenes.setdefault(self._simulation.state, len(self._scenes)))

    def _sense(self, facts: Sequence[SensedRecord]) -> None:
        state = self._simulation.task.extend(self._simulation.state) if facts else frozenset()
        for each in facts:
            if each.atom not in self._read:
                self._read.add(each.atom)
                atom = Atom.parse(each.atom)
                truth = holds_in(atom, state)
                reading = LabelledReading(atom.predicate, each.probability, truth)
                self.own.readings.append(reading)

    def _report(self, event: Acted) -> None:
        """A report counts where the action had something to do, and was not refused; what it
        undoes where something could come undone."""
        truth = event.truth
        acting = self._acting
        if truth is None or acting is None or truth.failure is Failure.REFUSED:
            return
        if truth.failure is not Failure.DEAD:
            came = Came.ACHIEVED if self._idle else _CAME[truth.failure]
            could = self._could_come_undone() if came is Came.SUCCESS else self._undoable
            lost = truth.undone is not None and not truth.undoing.startswith(BY_SOMEBODY)
            undone = lost if self._tells_undone and (could or lost) else None
            act = LabelledAct(self._trial, acting.name, came, undone, acting.arguments)
            self.own.acts.append(act)
        if not self._idle and event.report in (Report.DONE, Report.FAILED):
            reported = event.report is Report.FAILED
            report = LabelledReport(acting.name, reported, failed=not truth.succeeded)
            self.own.reports.append(report)

    def _could_come_undone(self) -> bool:
        return self._tells_undone and bool(self._simulation.undoable())

    def _truth(self, question: QuestionRecord) -> bool:
        return yes_is_right(question, self._simulation, self._actions)


def gather(
    cell: Cell,
    common: TrialConfig,
    episodes: Iterable[int],
    *,
    done: Callable[[], None] = lambda: None,
    own: OwnTask | None = None,
    heard: OwnWords | None = None,
) -> list[LabelledAnswer]:
    """Run trials in a simulated world and label all their answers.

    Args:
        cell: The task, monitor, VLM and world.
        common: Seed, rates of faults, limits.
        episodes: Their numbers.
        done: Called after each.
        own: The task, where it is the user's own.
        heard: Takes in what the robot itself said.

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
        if heard is not None:
            heard.add(labeller.own)
        done()
    return rows
