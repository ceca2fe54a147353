"""A monitor in a page: after every action its effects are asked about at two looks."""

from tpvqa.events.decision import Decision
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.requests import Ask, Look
from tpvqa.monitors.verdict import Verdict


class Twice:
    """Repeats an action as long as one of its effects is denied at two looks, and never replans.

    A check is a generator: it yields what it wants done, a look or a question, and is sent what
    came of it. So the trial logs everything, and a trial that was killed can be resumed.
    """

    name = "twice"

    def before(self, step: Step) -> Check:
        """Go on without a question."""
        return Verdict(Decision.GO_ON, "nothing is asked before an action")
        yield  # a generator, as the protocol wants

    def after(self, step: Step) -> Check:
        """Ask about all effects; what is denied twice is repeated."""
        questions = step.book.effects(step.action, step.state)
        for _ in range(2 if questions else 0):
            yield Look()
            answers = yield Ask(questions)
            denied = [each.question.text for each in answers if each.agrees is False]
            if not denied:
                break
        else:
            if questions:
                return Verdict(Decision.REPEAT, f"denied at two looks: {denied[0]}")
        return Verdict(
            Decision.GO_ON, "its effects were seen", step.task.apply(step.state, step.action)
        )
