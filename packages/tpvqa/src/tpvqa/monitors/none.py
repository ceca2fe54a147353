"""Planning without perception: the paper's baseline TP, and a run without a VLM."""

from tpvqa.events.decision import Decision
from tpvqa.monitors.capabilities import NeverAsks
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.verdict import Verdict


class NoMonitor(NeverAsks):
    """Believes that every action works, unless the skill itself says otherwise. It never looks."""

    name = "none"

    def before(self, step: Step) -> Check:
        """Go on."""
        return Verdict(Decision.GO_ON, "no perception")
        yield  # a generator, as the protocol wants

    def after(self, step: Step) -> Check:
        """Believe the effects."""
        if step.trouble:
            return Verdict(Decision.REPEAT, f"the skill reports: {step.trouble}")
        return Verdict(Decision.GO_ON, "no perception", step.task.apply(step.state, step.action))
        yield
