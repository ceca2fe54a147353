"""Planning without perception: the paper's baseline TP, and a run without a VLM."""

from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.verdict import Decision, Verdict


class NoMonitor:
    """Believes that every action works. It never looks and never asks."""

    name = "none"

    def before(self, step: Step) -> Check:
        """Go on."""
        return Verdict(Decision.GO_ON, "no perception")
        yield  # a generator, as the protocol wants

    def after(self, step: Step) -> Check:
        """Believe the effects."""
        return Verdict(Decision.GO_ON, "no perception", step.task.apply(step.state, step.action))
        yield
