"""A monitor that asks everything several times and lets no answer change anything.

Calibrations learn from it: as it never looks again because an answer did not please it, all of its
answers count, repeated ones too.
"""

from collections.abc import Sequence

from tpvqa.errors import PluginError
from tpvqa.events.decision import Decision
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.requests import Ask, Look
from tpvqa.monitors.verdict import Verdict
from tpvqa.questions import FactQuestion

LOOKS = 8


class Survey:
    """Follows the plan and asks all preconditions and effects, each at several looks.

    Args:
        looks: Looks at which every question is asked.
    """

    def __init__(self, looks: int = LOOKS):
        self.looks = looks

    @classmethod
    def from_spec(cls, arguments: str = "") -> "Survey":
        """Make it from `survey`, or `survey:K` for K looks.

        Raises:
            PluginError: K is not a number of looks.
        """
        if not arguments:
            return cls()
        if not arguments.isdecimal() or int(arguments) < 1:
            raise PluginError(f"'survey:{arguments}' is not understood. Write survey or survey:5.")
        return cls(int(arguments))

    @property
    def name(self) -> str:
        """What the log calls it."""
        return f"survey:{self.looks}"

    def before(self, step: Step) -> Check:
        """Ask all preconditions, and go on."""
        yield from self._ask(step.book.preconditions(step.action, step.state))
        return Verdict(Decision.GO_ON, "a survey goes on whatever is answered")

    def after(self, step: Step) -> Check:
        """Ask all effects, and believe them."""
        yield from self._ask(step.book.effects(step.action, step.state))
        state = step.task.apply(step.state, step.action)
        return Verdict(Decision.GO_ON, "a survey goes on whatever is answered", state)

    def _ask(self, questions: Sequence[FactQuestion]) -> Check:
        if questions:
            for _ in range(self.looks):
                yield Look()
                yield Ask(tuple(questions))
        return Verdict(Decision.GO_ON, "")
