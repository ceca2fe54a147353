"""A monitor that somebody else commands: it asks, looks and decides as it is told."""

from dataclasses import dataclass
from enum import StrEnum

from tpvqa.belief import Calibration
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, FaultRules, Rates
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.events.decision import Decision
from tpvqa.monitors import Ask, Check, Look, Step, Verdict
from tpvqa.observation import Observation
from tpvqa.pddl import Literal, Task
from tpvqa.plugins import PlainArguments
from tpvqa.questions import FactQuestion, QuestionBook
from tpvqa.vlm import Answer


class Command(StrEnum):
    """What may be commanded besides a question."""

    LOOK = "look"
    GO_ON = "go on"
    REPEAT = "repeat"
    REPLAN = "replan"
    DONE = "done"
    GIVE_UP = "give up"


@dataclass
class Commanded(PlainArguments):
    """Keeps a belief, and leaves every decision to who commands it.

    Each check begins with a look. Then it does what it is commanded, one thing after the other,
    until that is a decision. Where nobody commands it, it goes on.

    Args:
        task: The task.
        book: Its questions.
        rules: What the world file says about faults.
        calibration: What the VLM's answers are worth.

    Attributes:
        command: What it does next; taken once.
    """

    task: Task
    book: QuestionBook
    rules: FaultRules | None = None
    calibration: Calibration | None = None
    command: Command | FactQuestion | None = None
    name: str = "commanded"

    def __post_init__(self) -> None:
        self.belief = Belief(FaultModel(self.task, self.rules))
        known = self.calibration or Calibration.default()
        self._evidence = Evidence(self.belief, known, None)
        self._picture: tuple[bytes, ...] | int = 0

    @classmethod
    def from_spec(
        cls,
        arguments: str = "",
        *,
        task: Task,
        book: QuestionBook,
        rules: FaultRules | None = None,
        calibration: Calibration | None = None,
    ) -> "Commanded":
        """Make it from `commanded`."""
        return cls(task, book, rules, calibration)

    @property
    def questions(self) -> list[FactQuestion]:
        """Every question that may be asked, in an order that is always the same."""
        found: dict[str, FactQuestion] = {}
        for atom in sorted(self.task.reachable_atoms):
            if atom.predicate in self.task.fluents and self.book.asked(Literal(atom)):
                question = self.book.fact(Literal(atom))
                found.setdefault(question.text, question)
        return list(found.values())

    def looked(self, seen: Observation) -> None:
        """Take what a look showed, at once and not when the trial goes on."""
        self._picture = tuple(frame.data for frame in seen.frames.values()) or seen.look
        for fact in seen.facts:
            self._evidence.take_sensed(fact.atom, fact.probability)

    def answered(self, answers: list[Answer]) -> None:
        """Take answers, likewise."""
        for answer in answers:
            if isinstance(answer.question, FactQuestion):
                self._evidence.take(answer.question, answer, self._picture, None)

    def before(self, step: Step) -> Check:
        """As commanded."""
        return self._check(step, acted=False)

    def after(self, step: Step) -> Check:
        """Predict what the action led to; then as commanded."""
        self._evidence.rests_on(step.action)
        self.belief.act(step.action, Rates())
        self._evidence.acted(step.action.name, failed=step.reported)
        for fact in step.sensed:
            self._evidence.take_sensed(fact.atom, fact.probability)
        return self._check(step, acted=True)

    def _check(self, step: Step, *, acted: bool) -> Check:
        yield Look()
        while True:
            command, self.command = self.command, None
            if command is Command.LOOK:
                yield Look()
            elif isinstance(command, FactQuestion):
                yield Ask((command,))
            else:
                return self._verdict(step, command or Command.GO_ON, acted=acted)

    def _verdict(self, step: Step, command: Command, *, acted: bool) -> Verdict:
        decision = Decision(command.value)
        if decision is Decision.REPEAT and not acted:
            decision = Decision.GO_ON
        state = self.belief.most_probable()[0]
        return Verdict(decision, "as commanded", state=state)
