"""The paper's ablation: effects are checked, preconditions are believed."""

from tpvqa.events.decision import Decision
from tpvqa.monitors.asker import Asker, check_effects
from tpvqa.monitors.majority import Majority
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.verdict import Verdict


class EffectVQA:
    """Zhang et al. 2023, section "Baselines": TPVQA without questions about preconditions.

    Args:
        majority: When answers deny an action's effects.
        looks: How often to look again where every answer abstains, before stopping.
    """

    name = "effectvqa"

    def __init__(self, *, majority: Majority | str = Majority.TIE_DENIES, looks: int = 3):
        self._asker = Asker(majority=majority, looks=looks)

    def before(self, step: Step) -> Check:
        """Go on."""
        return Verdict(Decision.GO_ON, "preconditions are not asked about")
        yield  # a generator, as the protocol wants

    def after(self, step: Step) -> Check:
        """Check the effects: go on, or repeat the action."""
        return (yield from check_effects(self._asker, step))
