"""A baseline of the paper: "Is it possible to <action> here?", "Was <action> successful?"."""

from tpvqa.errors import PluginError
from tpvqa.events.decision import Decision
from tpvqa.monitors.asker import Asker, give_up
from tpvqa.monitors.capabilities import AsksActions
from tpvqa.monitors.memory import FactMemory
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.verdict import Verdict
from tpvqa.pddl import Literal, State
from tpvqa.plugins import PlainArguments


class PaLMEVQA(AsksActions, PlainArguments):
    """Zhang et al. 2023, section "Baselines", with the questions of Driess et al. 2023.

    A no to "Is it possible …?" names no fact. So all preconditions that could have been asked
    about are taken out of the state by TPVQA's rule, and a new plan is made from there.

    Args:
        start_over: Instead plan from the task's initial state, as the authors' scripts do.
        looks: How often to look again where the answer abstains, before stopping.
    """

    def __init__(self, *, start_over: bool = False, looks: int = 3):
        self._asker, self.start_over = Asker(looks=looks), start_over
        self._memory: FactMemory | None = None

    @classmethod
    def from_spec(cls, arguments: str = "") -> "PaLMEVQA":
        """Make it from `palmevqa`, or from `palmevqa:start-over`.

        Raises:
            PluginError: The argument is another.
        """
        if arguments not in ("", "start-over"):
            raise PluginError(
                f"'palmevqa:{arguments}' is not understood. Write palmevqa or palmevqa:start-over."
            )
        return cls(start_over=bool(arguments))

    @property
    def name(self) -> str:
        """What the log calls it."""
        return "palmevqa:start-over" if self.start_over else "palmevqa"

    def before(self, step: Step) -> Check:
        """Ask whether the action is possible: go on, or replan."""
        question = step.book.possible(step.action)
        for _ in range(2):  # where nothing can be taken out: one more look, then the robot acts
            denied, _ = yield from self._asker.ask([question])
            if denied is None:
                return give_up([question])
            if not denied:
                return Verdict(Decision.GO_ON, f"yes: {question.text}")
            corrected = self._corrected(step)
            if corrected != step.state:
                self._remember(step).correct(step.state, corrected, self._denied(step))
                return Verdict(Decision.REPLAN, f"no: {question.text}", corrected)
        return Verdict(
            Decision.GO_ON, f"no: {question.text}; looked twice, nothing else to believe"
        )

    def after(self, step: Step) -> Check:
        """Ask whether the action was successful: go on, or repeat it."""
        question = step.book.successful(step.action)
        denied, _ = yield from self._asker.ask([question])
        if denied is None:
            return give_up([question])
        if denied:
            return Verdict(Decision.REPEAT, f"no: {question.text}")
        state = step.task.apply(step.state, step.action)
        self._remember(step).record(step.state, state)
        return Verdict(Decision.GO_ON, f"yes: {question.text}", state)

    def _corrected(self, step: Step) -> State:
        if self.start_over:
            return step.task.init
        return self._remember(step).take_out(step.state, self._denied(step))

    def _denied(self, step: Step) -> list[Literal]:
        """What a no denies: all preconditions that could have been asked about."""
        asked = step.book.preconditions(step.action, step.state)
        return [question.literal for question in asked]

    def _remember(self, step: Step) -> FactMemory:
        if self._memory is None:
            self._memory = FactMemory(step.task)
        return self._memory
