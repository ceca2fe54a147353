"""A trial's events as `Episode` and `Belief`, values by field: for topics and for bags."""

from collections.abc import Mapping
from typing import Any

from tpvqa.events import EVENT, Event, TrialState
from tpvqa.events.events import Decided

Values = Mapping[str, Any]


def episode_values(state: TrialState, event: Event, episode: str) -> dict[str, Any]:
    """The fields of `Episode`, but for its stamp.

    Args:
        state: Where the trial stands after the event.
        event: The event.
        episode: The episode's folder.
    """
    plan, decided = state.plan, state.decided
    return {
        "episode": episode,
        "event": event.number,
        "kind": event.kind,
        "plan": [] if plan is None else [step.pddl() for step in plan.plan],
        "step": state.index,
        "when": state.when,
        "decision": "" if decided is None else str(decided.course),
        "reason": "" if decided is None else decided.reason,
        "actions": state.actions,
        "questions": state.questions,
        "looks": state.looks,
        "line": EVENT.dump_json(event, exclude_none=True, by_alias=True).decode(),
    }


def belief_values(state: TrialState, event: Event, episode: str) -> dict[str, Any] | None:
    """The fields of `Belief`, but for its stamp; None of an event that is no decision.

    Args:
        state: Where the trial stands after the event.
        event: The event.
        episode: The episode's folder.
    """
    if not isinstance(event, Decided):
        return None
    known = event.belief or {atom.pddl(): 1.0 for atom in state.believed}
    facts = [{"fact": fact, "probability": float(p)} for fact, p in sorted(known.items())]
    return {"episode": episode, "event": event.number, "facts": facts}
