"""A rival of all perception: every action so many times, and not a single look."""

import re

from tpvqa.errors import PluginError, cut
from tpvqa.events.decision import Decision
from tpvqa.monitors.capabilities import NeverAsks
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.verdict import Verdict


class Blind(NeverAsks):
    """Does every action of the plan several times in a row, whatever the skill reports; as often
    as the limit of repeats allows.

    Args:
        times: How many times.
    """

    def __init__(self, times: int):
        self.times = times

    @classmethod
    def from_spec(cls, arguments: str = "") -> "Blind":
        """Make it from `blind:K`.

        Raises:
            PluginError: K is not a number of times.
        """
        if not re.fullmatch(r"0*[1-9][0-9]{0,3}", arguments):
            raise PluginError(
                f"'blind:{cut(arguments)}' is not understood. Write blind:K for every action K "
                "times, e.g. blind:5; at most 9999."
            )
        return cls(int(arguments))

    @property
    def name(self) -> str:
        """What the log calls it."""
        return f"blind:{self.times}"

    def before(self, step: Step) -> Check:
        """Go on."""
        return Verdict(Decision.GO_ON, "no perception")
        yield  # a generator, as the protocol wants

    def after(self, step: Step) -> Check:
        """Repeat the action until it was done so many times, then believe the effects."""
        done = step.attempt + 1
        may = step.repeats_left is None or step.repeats_left > 0
        if done < self.times and may:
            return Verdict(Decision.REPEAT, f"done {done} of {self.times} times, without a look")
        state = step.task.apply(step.state, step.action)
        return Verdict(Decision.GO_ON, f"done {done} times, without a look", state)
        yield
