"""What a monitor decides, and why."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from tpvqa.events.decision import Decision
from tpvqa.pddl import Atom, State
from tpvqa.planning import Plan


@dataclass(frozen=True, slots=True)
class Verdict:
    """A decision with its reason.

    Attributes:
        decision: What to do.
        reason: Why, in one sentence.
        state: What is believed from now on; None where it has not changed. A replan starts
            from it.
        step: At which step of the plan to go on; None for the natural one (the action itself
            before it, the next one after it).
        belief: Probabilities of the facts that the plan needs, where a monitor keeps them.
        plan: To replan: the plan from `state` that the decision rests on; None to have one made.
    """

    decision: Decision
    reason: str
    state: State | None = None
    step: int | None = None
    belief: Mapping[Atom, float] = field(default_factory=dict)
    plan: Plan | None = None
