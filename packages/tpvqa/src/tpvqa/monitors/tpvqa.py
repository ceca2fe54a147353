"""The paper's monitor: ask all preconditions before an action, all effects after it, and count."""

from collections.abc import Generator, Sequence
from typing import Any

from tpvqa.errors import PluginError
from tpvqa.events.decision import Decision
from tpvqa.monitors.asker import Asker, check_effects, give_up, tally
from tpvqa.monitors.majority import Majority
from tpvqa.monitors.memory import FactMemory
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.requests import Ask, Request
from tpvqa.monitors.verdict import Verdict
from tpvqa.pddl import Atom, Literal, State
from tpvqa.questions import FactQuestion, Way
from tpvqa.vlm import Answer, Reply


class TPVQA:
    """Zhang et al. 2023, section "Method".

    Before an action all its preconditions are asked. Where the majority denies them, the denied
    facts are taken out of the state and a new plan is made from there. After it all its effects
    are asked, negative ones too; where the majority denies them, the action is repeated.

    Args:
        majority: When answers deny an action.
        looks: How often to look again where every answer abstains, before stopping.
        votes: Looks at which every question is asked; each question's answer is the vote.
        alternatives: Whether to ask where else a thing is, once a fact about it is denied.

    Example:
        >>> TPVQA.from_spec("5:strict").name
        'tpvqa:5:strict'
    """

    def __init__(
        self,
        *,
        majority: Majority | str = Majority.TIE_DENIES,
        looks: int = 3,
        votes: int = 1,
        alternatives: bool = True,
    ):
        self._asker = Asker(majority=majority, looks=looks, votes=votes)
        self.alternatives = alternatives
        self._memory: FactMemory | None = None

    @classmethod
    def from_spec(
        cls, arguments: str = "", *, majority: Majority | str = Majority.TIE_DENIES
    ) -> "TPVQA":
        """Make it from `tpvqa[:K][:MAJORITY]`: votes over K looks, `tie` or `strict`.

        Raises:
            PluginError: The arguments are others.
        """
        votes, _, rule = arguments.partition(":")
        if votes and not votes.isdecimal():
            votes, rule = "", arguments
        if rule not in ("", *Majority):
            raise PluginError(
                f"'tpvqa:{arguments}' is not understood. Write tpvqa, tpvqa:K for votes over "
                "K looks, e.g. tpvqa:5, or either with the majority tie or strict at its end, "
                "e.g. tpvqa:5:strict."
            )
        return cls(majority=rule or majority, votes=int(votes or 1))

    @property
    def name(self) -> str:
        """What the log calls it."""
        votes = "" if self._asker.votes == 1 else f":{self._asker.votes}"
        strict = ":strict" if self._asker.majority is Majority.STRICT else ""
        return f"tpvqa{votes}{strict}"

    def before(self, step: Step) -> Check:
        """Check the preconditions: go on, or replan from the corrected state."""
        questions = step.book.preconditions(step.action, step.state)
        denied, answers = yield from self._asker.ask(questions)
        if denied is None:
            return give_up(questions)
        if not denied:
            return Verdict(Decision.GO_ON, tally("preconditions", answers))
        corrected = yield from self._correct(step, questions, answers)
        if corrected == step.state:
            # A fact with nothing before it stays: one more look, then the robot acts.
            denied, answers = yield from self._asker.ask(questions)
            if denied is None:
                return give_up(questions)
            if not denied:
                return Verdict(
                    Decision.GO_ON, f"{tally('preconditions', answers)} at the second look"
                )
            corrected = yield from self._correct(step, questions, answers)
        if corrected == step.state:
            reason = f"{tally('preconditions', answers)}; looked twice, nothing else to believe"
            return Verdict(Decision.GO_ON, reason)
        self._remember(step).correct(step.state, corrected)
        reason = f"{tally('preconditions', answers)}; {_change(step.state, corrected)}"
        return Verdict(Decision.REPLAN, reason, corrected)

    def after(self, step: Step) -> Check:
        """Check the effects: go on, or repeat the action."""
        verdict = yield from check_effects(self._asker, step)
        if verdict.state is not None:
            self._remember(step).record(step.state, verdict.state)
        return verdict

    def _correct(
        self, step: Step, questions: Sequence[FactQuestion], answers: Sequence[Answer]
    ) -> Generator[Request, Any, State]:
        """Take the denied facts out, believing an alternative where exactly one is affirmed."""
        memory = self._remember(step)
        denied = [
            question.literal
            for question, answer in zip(questions, answers, strict=True)
            if answer.agrees is False
        ]
        seen: list[Atom] = []
        unseen: list[Atom] = []
        if self.alternatives:
            for literal in denied:
                affirmed, refused = yield from self._look_elsewhere(step, literal)
                seen += affirmed
                unseen += refused
        return memory.take_out(step.state, denied, seen=seen, unseen=unseen)

    def _look_elsewhere(
        self, step: Step, denied: Literal
    ) -> Generator[Request, Any, tuple[list[Atom], list[Atom]]]:
        """Which alternative of a denied fact the VLM affirms, if exactly one, and which not."""
        if not denied.positive:
            return [], []
        asked_already = step.book.fact(denied, way=Way.ALTERNATIVE).text
        atoms_by_text: dict[str, list[Atom]] = {}
        questions: dict[str, FactQuestion] = {}
        for atom in self._remember(step).alternatives(denied.atom):
            literal = Literal(atom)
            # Where a "no" would say nothing (near another thing), a "yes" decides nothing.
            if step.book.asked(literal) and step.book.asked(literal.negate()):
                question = step.book.fact(literal, way=Way.ALTERNATIVE)
                if question.text != asked_already:
                    questions.setdefault(question.text, question)
                    atoms_by_text.setdefault(question.text, []).append(atom)
        if not questions:
            return [], []
        answers: list[Answer] = yield Ask(tuple(questions.values()))

        def told(reply: Reply) -> list[list[Atom]]:
            return [atoms_by_text[a.question.text] for a in answers if a.reply is reply]

        affirmed = told(Reply.YES)
        refused = [atom for atoms in told(Reply.NO) for atom in atoms]
        return affirmed[0] if len(affirmed) == 1 else [], refused

    def _remember(self, step: Step) -> FactMemory:
        if self._memory is None:
            self._memory = FactMemory(step.task)
        return self._memory


def _change(before: State, after: State) -> str:
    gone = ", ".join(map(str, sorted(before - after)))
    new = ", ".join(map(str, sorted(after - before)))
    return f"believing {new or 'nothing'} instead of {gone or 'nothing'}"
