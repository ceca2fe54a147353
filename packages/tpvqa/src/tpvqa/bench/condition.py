"""What differs between cells besides task, monitor, VLM and world, as users write it."""

import re
from typing import Any

from tpvqa.errors import BenchError, shown, suggestion

RATES = ("failure", "disturbance", "spontaneous")
LIMITS = ("repeats", "replans", "actions", "seconds")
UNBOUND = {"repeats": "none", "replans": "none", "actions": "50x"}
"""What `limits=none` stands for: who does not come to an end with these has failed."""
STARTS = {"start": "what", "priors": "priors"}
FAULTS = ("redo", "moved", "dead", "elsewhere")
OTHERS = (*FAULTS, "limits", "planner", "wording", "believed", "carried", *STARTS)


def settings_of(condition: str) -> dict[str, str]:
    """The settings of a condition, by name.

    Raises:
        BenchError: It is not understood.
    """
    found: dict[str, str] = {}
    for part in condition.split(",") if condition else []:
        name, _, value = part.partition("=")
        known = (*RATES, *LIMITS, *OTHERS)
        if name not in known or not value or name in found:
            raise not_understood(condition, "" if name in known else suggestion(name, known))
        found[name] = value
    return found


def changes_of(condition: str) -> dict[str, Any]:
    """What a condition changes of a trial's configuration, as `TrialConfig.but` takes it.

    Raises:
        BenchError: It is not understood.
    """
    settings = settings_of(condition)
    try:
        simulation: dict[str, Any] = {
            name: float(settings[name]) for name in RATES if name in settings
        }
    except ValueError:
        raise not_understood(condition) from None
    if settings.get("limits", "none") != "none":
        raise not_understood(condition)
    limits = {**(UNBOUND if "limits" in settings else {})}
    limits |= {name: settings[name] for name in LIMITS if name in settings}
    simulation |= {name: settings[name] for name in FAULTS if name in settings}
    changes: dict[str, Any] = {"simulation": simulation, "limits": limits}
    start = {key: settings[name] for name, key in STARTS.items() if name in settings}
    if start:
        changes["start"] = start
    if "wording" in settings:
        changes["wording"] = settings["wording"]
    if "planner" in settings:
        changes["planner"] = {"spec": settings["planner"]}
    return changes


def normalised(condition: str) -> str:
    """A condition without spaces to spare, so that it is the same however it was typed."""
    parts = (" ".join(part.split()) for part in condition.split(","))
    return ",".join(re.sub(r" ?([=+:]) ?", r"\1", part) for part in parts if part)


def not_understood(condition: str, meant: str = "") -> BenchError:
    """What to say of a condition that cannot be read, or holds a value out of its range.

    Args:
        condition: As it was written.
        meant: The end of a sentence that says what may have been meant.
    """
    return BenchError(
        f"The condition {shown(condition)} is not understood{meant or '.'} Write settings with "
        f"commas: rates of faults from 0 to 1 ({', '.join(RATES)}), redo=free, risky or refused, "
        "moved=RATE, dead=SKILL, elsewhere=THINGS, limits "
        f"({', '.join(LIMITS)}; limits=none), planner=PLANNER, wording=paper, start=unknown, "
        "priors=FILE, believed=VLM, carried=EPISODES; for example failure=0.4,actions=30"
    )
