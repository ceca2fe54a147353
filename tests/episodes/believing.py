"""A small episode of a monitor that believes, told by hand: three actions, two plans considered."""

from pathlib import Path

from tpvqa.config import TrialConfig
from tpvqa.events import Event, Started
from tpvqa.events.events import Acted, Acting, ActionRecord, Decided, Ended, OutcomeRecord, PlanMade
from tpvqa.monitors import Decision
from tpvqa.tasks import find_task
from tpvqa.worlds import Report
from tpvqa.worlds.outcome import Failure

FLIPPED = "(near bread)"
DOUBTED = "(in_hand bread left)"
UNSURE = "(on bread plate)"
SURE = "(on plate table)"

FIND = ActionRecord(name="find", arguments=("bread", "sink"), said="find the bread")
PICK = ActionRecord(name="pick_up", arguments=("bread", "table", "left"), said="pick up the bread")
OTHER = ActionRecord(name="find", arguments=("tv", "sink"), said="find the TV")


def started(*, domain: str | None = None) -> Started:
    """The beginning of an episode of `serve_breakfast`, or of one in another domain."""
    files = find_task("serve_breakfast")
    return Started(
        version="0",
        task="serve_breakfast",
        domain_file="",
        problem_file="",
        domain=domain or Path(files.domain).read_text(),
        problem=Path(files.problem).read_text(),
        questions=None if domain else Path(str(files.questions)).read_text(),
        initial=("(near sink)", SURE),
        goal="",
        monitor="belief",
        vlm="oracle",
        world="symbolic",
        planner="fast-downward",
        config=TrialConfig(task="serve_breakfast"),
    )


def plan(*actions: ActionRecord, considered: bool = False) -> PlanMade:
    """A plan, followed or only considered."""
    return PlanMade(state=(), result="plan", plan=actions, considered=considered)


def decided(
    when: str, step: int, decision: Decision, near: float | None = None, held: float | None = None
) -> Decided:
    """A decision, with a belief where probabilities are given."""
    given = {FLIPPED: near, DOUBTED: held}
    belief = {fact: p for fact, p in given.items() if p is not None}
    return Decided.model_validate(
        {
            "when": when,
            "step": step,
            "action": "(find bread sink)" if step == 0 else "(pick_up bread table left)",
            "decision": decision,
            "reason": f"because {when} {step}",
            "belief": {**belief, UNSURE: 0.3, SURE: 0.999} if belief else {},
        }
    )


def done(
    step: int, attempt: int, *, added: tuple[str, ...] = (), removed: tuple[str, ...] = ()
) -> list[Event]:
    """An action with what truly came of it."""
    truth = OutcomeRecord(failure=None if added else Failure.CHANCE, added=added, removed=removed)
    return [
        Acting(step=step, action=(FIND, PICK)[step], attempt=attempt),
        Acted(report=Report.DONE, seconds=0.0, truth=truth),
    ]


def believing() -> list[Event]:
    """The bread is found, missed by the hand, believed to be in it all the same, then taken."""
    return [
        started(),
        plan(FIND, PICK),
        decided("before", 0, Decision.GO_ON, near=0.001, held=0.001),
        *done(0, 0, added=(FLIPPED,), removed=("(near sink)",)),
        decided("after", 0, Decision.GO_ON, near=0.999, held=0.001),
        decided("before", 1, Decision.GO_ON),
        *done(1, 0),
        plan(OTHER, considered=True),
        decided("after", 1, Decision.REPEAT, near=0.999, held=0.6),
        decided("before", 1, Decision.GO_ON, near=0.999, held=0.6),
        *done(1, 1, added=(DOUBTED,)),
        plan(OTHER, PICK, considered=True),
        decided("after", 1, Decision.DONE, near=0.999, held=0.97),
        Ended(
            because="goal",
            believed_goal=True,
            goal_holds=True,
            completed=True,
            actions=3,
            questions=0,
            looks=0,
            repeats=1,
            replans=0,
        ),
    ]


def without_belief(events: list[Event]) -> list[Event]:
    """The same episode of a monitor that keeps no probabilities."""
    return [
        event.model_copy(update={"belief": {}}) if isinstance(event, Decided) else event
        for event in events
    ]


def all_followed(events: list[Event]) -> list[Event]:
    """The same episode with every plan followed."""
    return [
        event.model_copy(update={"considered": False}) if isinstance(event, PlanMade) else event
        for event in events
    ]
