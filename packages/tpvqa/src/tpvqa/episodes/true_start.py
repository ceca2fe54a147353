"""How a simulated world truly began, where that is not as the problem says."""

from collections.abc import Callable

from tpvqa.events.events import Started

MOST = 8
"""Facts that are said; a state that somebody named may differ in hundreds."""


def true_start_said(started: Started, say: Callable[[str], str]) -> str:
    """What holds at first and what does not, unlike the problem says; empty where all is as it
    says, or the world is no simulated one.

    Args:
        started: The beginning of the episode.
        say: Says a fact, given as PDDL, in words.
    """
    if started.true_start is None or started.config.simulation is None:
        return ""
    there, said = frozenset(started.true_start), frozenset(started.initial)
    differs = [say(each) for each in sorted(there - said)]
    differs += [f"not {say(each)}" for each in sorted(said - there)]
    more = [f"and {len(differs) - MOST} more"] if len(differs) > MOST else []
    return ", ".join((*differs[:MOST], *more))
