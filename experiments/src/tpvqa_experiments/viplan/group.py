"""What a line of the table is of."""

from collections.abc import Mapping
from dataclasses import dataclass

from tpvqa_experiments.viplan.problems import Environment
from tpvqa_experiments.viplan.published import Key

SETTINGS: Mapping[str, str] = {
    "no_cot": "failure=0,disturbance=0",
    "fail01_no_cot": "failure=0.1,disturbance=0",
}
"""ViPlan's settings, as conditions: whether actions fail."""
MOST = 20
"""Actions that ViPlan allows."""
LIMITS: Mapping[str, str] = {str(MOST): f"limits=none,actions={MOST}", "none": "limits=none"}
"""Ways of limiting a trial, as conditions."""


@dataclass(frozen=True, slots=True)
class Group:
    """The problems of a split, with one model and one monitor.

    Attributes:
        environment: Where.
        setting: Of `SETTINGS`.
        split: How hard the problems are.
        model: The recorded model.
        monitor: Specification of the monitor.
        limit: Of `LIMITS`.
    """

    environment: Environment
    setting: str
    split: str
    model: str
    monitor: str
    limit: str

    @property
    def key(self) -> Key:
        """Under which the published runs are found."""
        return self.environment.value, self.setting, self.split, self.model

    @property
    def compared(self) -> bool:
        """Whether it is what was published: its grounder, with its limit."""
        return self.monitor == "grounder" and self.limit == str(MOST)
