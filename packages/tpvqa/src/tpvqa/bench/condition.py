"""What differs between cells besides task, monitor, VLM and world, as users write it."""

from collections.abc import Mapping
from typing import Any

from tpvqa.errors import BenchError

RATES = ("failure", "disturbance", "spontaneous")
LIMITS: Mapping[str, type] = {"repeats": int, "replans": int, "actions": int, "seconds": float}
OTHERS = ("planner", "believed", "carried")


def settings_of(condition: str) -> dict[str, str]:
    """The settings of a condition, by name.

    Raises:
        BenchError: It is not understood.
    """
    found: dict[str, str] = {}
    for part in condition.split(",") if condition else []:
        name, _, value = part.partition("=")
        if name not in (*RATES, *LIMITS, *OTHERS) or not value or name in found:
            raise not_understood(condition)
        found[name] = value
    return found


def changes_of(condition: str) -> dict[str, Any]:
    """What a condition changes of a trial's configuration, as `TrialConfig.but` takes it.

    Raises:
        BenchError: It is not understood.
    """
    settings = settings_of(condition)
    try:
        simulation = {name: float(settings[name]) for name in RATES if name in settings}
        limits = {name: kind(settings[name]) for name, kind in LIMITS.items() if name in settings}
    except ValueError:
        raise not_understood(condition) from None
    changes: dict[str, Any] = {"simulation": simulation, "limits": limits}
    if "planner" in settings:
        changes["planner"] = {"spec": settings["planner"]}
    return changes


def normalised(condition: str) -> str:
    """A condition without spaces, so that it is the same however it was typed."""
    return ",".join(part.strip().replace(" ", "") for part in condition.split(",") if part.strip())


def not_understood(condition: str) -> BenchError:
    """What to say of a condition that cannot be read, or holds a value out of its range."""
    return BenchError(
        f"The condition {condition!r} is not understood. Write settings with commas: rates of "
        f"faults ({', '.join(RATES)}), limits ({', '.join(LIMITS)}), planner=PLANNER, "
        "believed=VLM, carried=EPISODES; for example failure=0.4,actions=30"
    )
