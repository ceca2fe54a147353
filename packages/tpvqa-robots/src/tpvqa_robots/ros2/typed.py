"""What loop and skill server say to each other in messages of their own, `tpvqa_interfaces`.

The package is built where it is wanted (`tpvqa build-interfaces`), so it is imported late.
"""

import math
from collections.abc import Iterable
from importlib.util import find_spec
from typing import Any

from tpvqa.errors import TpvqaError
from tpvqa.observation import SensedFact
from tpvqa.pddl import Atom
from tpvqa.worlds import Execution, Report
from tpvqa_robots.ros2.wire import Result

CONTROLLER, SERVER = "controller", "server"
"""Topics beside an action: who commands it, and how its server stands."""
_REPORTS = (Report.DONE, Report.FAILED, Report.CANCELLED, Report.LATE, Report.UNAVAILABLE)
"""In the order of ExecuteSkill's numbers, from 1."""


def built() -> bool:
    """Whether the messages are there."""
    return find_spec("tpvqa_interfaces") is not None


def see_built(whose: str) -> None:
    """See that they are.

    Raises:
        TpvqaError: They are not; says what to do.
    """
    if not built():
        raise TpvqaError(
            f"{whose} needs the ROS 2 package tpvqa_interfaces, which is not built here: "
            "tpvqa build-interfaces, or colcon in a workspace of ROS 2"
        )


def finite(number: float) -> float | None:
    """A number; None where it is none."""
    return float(number) if math.isfinite(number) else None


def seconds_of(stamp: Any) -> float | None:
    """A `builtin_interfaces/Time` in seconds; None where it was not set."""
    if stamp.sec == 0 and stamp.nanosec == 0:
        return None
    return float(stamp.sec) + float(stamp.nanosec) / 1e9


def stamped(stamp: Any, seconds: float) -> Any:
    """The `builtin_interfaces/Time`, set."""
    stamp.sec = int(seconds)
    stamp.nanosec = min(round((seconds - int(seconds)) * 1e9), 999_999_999)
    return stamp


def fact_messages(facts: Iterable[tuple[str, float]]) -> list[Any]:
    """Facts as PDDL writes them, with probabilities, as messages."""
    from tpvqa_interfaces.msg import Fact

    return [Fact(fact=fact, probability=float(probability)) for fact, probability in facts]


def result_message(result: Any, done: Execution, at: float) -> Any:
    """The result of `ExecuteSkill`, set."""
    result.report = _REPORTS.index(done.report) + 1
    result.message, result.seconds = done.message, float(done.seconds)
    result.facts = fact_messages((each.atom.pddl(), each.probability) for each in done.facts)
    stamped(result.ended, at)
    return result


def result_of(message: Any, came: float) -> Result | None:
    """The result that a message tells; None where it is malformed: then nothing is known.

    Args:
        message: Of `ExecuteSkill`.
        came: When it came; it counts where the message does not say when the skill ended.
    """
    if not 1 <= message.report <= len(_REPORTS) or finite(message.seconds) is None:
        return None
    facts = []
    for each in message.facts:
        if not 0 <= each.probability <= 1:
            return None
        try:
            facts.append(SensedFact(Atom.parse(each.fact), float(each.probability)))
        except ValueError:
            return None
    ended = seconds_of(message.ended)
    report = _REPORTS[message.report - 1]
    return Result(
        report,
        float(message.seconds),
        message.message,
        tuple(facts),
        came if ended is None else ended,
    )
