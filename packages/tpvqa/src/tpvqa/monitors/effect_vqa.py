"""The paper's ablation: effects are checked, preconditions are believed."""

from tpvqa.errors import PluginError
from tpvqa.events.decision import Decision
from tpvqa.monitors.asker import Asker, check_effects
from tpvqa.monitors.majority import Majority
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.verdict import Verdict
from tpvqa.plugins import PlainArguments


class EffectVQA(PlainArguments):
    """Zhang et al. 2023, section "Baselines": TPVQA without questions about preconditions.

    Args:
        majority: When answers deny an action's effects.
        looks: How often to look again where every answer abstains, before stopping.
    """

    def __init__(self, *, majority: Majority | str = Majority.TIE_DENIES, looks: int = 3):
        self._asker = Asker(majority=majority, looks=looks)

    @classmethod
    def from_spec(
        cls, arguments: str = "", *, majority: Majority | str = Majority.TIE_DENIES
    ) -> "EffectVQA":
        """Make it from `effectvqa`, or with the majority at its end: `effectvqa:strict`.

        Raises:
            PluginError: There is no such majority.
        """
        if arguments not in ("", *Majority):
            raise PluginError(
                f"'effectvqa:{arguments}' is not understood. Write effectvqa, or with the majority "
                "tie, strict or any at its end, e.g. effectvqa:strict."
            )
        return cls(majority=arguments or majority)

    @property
    def name(self) -> str:
        """What the log calls it."""
        return "effectvqa:strict" if self._asker.majority is Majority.STRICT else "effectvqa"

    def before(self, step: Step) -> Check:
        """Go on."""
        return Verdict(Decision.GO_ON, "preconditions are not asked about")
        yield  # a generator, as the protocol wants

    def after(self, step: Step) -> Check:
        """Check the effects: go on, or repeat the action."""
        return (yield from check_effects(self._asker, step))
