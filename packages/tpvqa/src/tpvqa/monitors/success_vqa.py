"""A baseline of the paper: "Did the robot successfully <action>?"; nothing before an action."""

from tpvqa.events.decision import Decision
from tpvqa.monitors.asker import Asker, give_up
from tpvqa.monitors.capabilities import AsksActions
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.verdict import Verdict


class SuccessVQA(AsksActions):
    """Zhang et al. 2023, section "Baselines", with the question of Du et al. 2023.

    Args:
        looks: How often to look again where the answer abstains, before stopping.
    """

    name = "successvqa"

    def __init__(self, *, looks: int = 3):
        self._asker = Asker(looks=looks)

    def before(self, step: Step) -> Check:
        """Go on."""
        return Verdict(Decision.GO_ON, "affordance is not asked about")
        yield  # a generator, as the protocol wants

    def after(self, step: Step) -> Check:
        """Ask whether the robot did it: go on, or repeat the action."""
        question = step.book.did(step.action)
        denied, _ = yield from self._asker.ask([question])
        if denied is None:
            return give_up([question])
        if denied:
            return Verdict(Decision.REPEAT, f"no: {question.text}")
        return Verdict(
            Decision.GO_ON, f"yes: {question.text}", step.task.apply(step.state, step.action)
        )
