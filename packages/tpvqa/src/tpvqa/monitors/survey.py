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
TWICE = "twice"


class Survey:
    """Follows the plan and asks all preconditions and effects, each at several looks.

    Args:
        looks: Looks at which every question is asked.
        twice: Whether every action is done twice: then it also shows what comes of doing again
            what is done, and gets further where actions fail.
    """

    def __init__(self, looks: int = LOOKS, *, twice: bool = False):
        self.looks, self.twice = looks, twice

    @classmethod
    def from_spec(cls, arguments: str = "") -> "Survey":
        """Make it from `survey`, `survey:K` for K looks, or either with `:twice` behind it.

        Raises:
            PluginError: K is not a number of looks.
        """
        words = arguments.split(":") if arguments else []
        twice = words[-1:] == [TWICE]
        looks = words[:-1] if twice else words
        if not looks:
            return cls(twice=twice)
        if len(looks) > 1 or not looks[0].isdecimal() or int(looks[0]) < 1:
            raise PluginError(
                f"'survey:{arguments}' is not understood. Write survey or survey:5, with :twice "
                "behind it to do every action twice."
            )
        return cls(int(looks[0]), twice=twice)

    @property
    def name(self) -> str:
        """What the log calls it."""
        return f"survey:{self.looks}{f':{TWICE}' if self.twice else ''}"

    def before(self, step: Step) -> Check:
        """Ask all preconditions, and go on."""
        yield from self._ask(step.book.preconditions(step.action, step.state))
        return Verdict(Decision.GO_ON, "a survey goes on whatever is answered")

    def after(self, step: Step) -> Check:
        """Ask all effects, and believe them, or do the action once more."""
        yield from self._ask(step.book.effects(step.action, step.state))
        if self.twice and step.attempt == 0 and step.repeats_left != 0:
            return Verdict(Decision.REPEAT, "a survey does every action twice")
        state = step.task.apply(step.state, step.action)
        return Verdict(Decision.GO_ON, "a survey goes on whatever is answered", state)

    def _ask(self, questions: Sequence[FactQuestion]) -> Check:
        if questions:
            for _ in range(self.looks):
                yield Look()
                yield Ask(tuple(questions))
        return Verdict(Decision.GO_ON, "")
