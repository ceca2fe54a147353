"""Several searches of one task: another where the first finds nothing in its share of the time, or
ever better ones until the time is over."""

import time
from collections.abc import Iterable
from typing import Any

from tpvqa.pddl.worker.grounding import AtomKey, SASTemplate
from tpvqa.pddl.worker.search import Searcher, SearchOutcome

_SHARES = ((0.1, 3.0), (0.5, 60.0))
"""Of the time that is left, what the first search and the one that follows it get, and the seconds
that they get where the time is not limited. What is over then is the first one's again."""


def sought(
    searcher: Searcher,
    template: SASTemplate,
    state: Iterable[AtomKey],
    search: str,
    searches: dict[str, Any],
    *,
    seconds: float | None,
    memory: int | None,
) -> SearchOutcome:
    """Seek a plan.

    Args:
        searcher: What runs the searches.
        template: The SAS+ task.
        state: Its initial state.
        search: The first search.
        searches: Of what may stand here besides, "quick": whether the first search is one that the
            next process may read the task for; "then": the search that follows where the first
            finds nothing in its share of the time; "better": searches with a `{bound}`, each for a
            plan of less cost than the last, for so many seconds at most as "improve" says.
        seconds: The time limit; None for none.
        memory: The limit of a search's memory in MiB.
    """
    state = tuple(state)
    end = None if seconds is None else time.monotonic() + seconds
    then, quick = searches.get("then"), bool(searches.get("quick"))
    stages = (
        [(search, 1.0, None)]
        if then is None
        else [
            (search, *_SHARES[0]),
            (then, *_SHARES[1]),
            (search, 1.0, None),
        ]
    )
    for chosen, share, longest in stages:
        left = longest if end is None else share * max(0.0, end - time.monotonic())
        outcome = searcher.run(
            template,
            state,
            chosen,
            seconds=left,
            memory=memory,
            ahead=quick and chosen == search,
        )
        if outcome.kind not in ("timeout", "memory", "incomplete"):
            break
    if outcome.kind == "plan":
        until = time.monotonic() + float(searches.get("improve", 0))
        until = until if end is None else min(end, until)
        better = searches.get("better", ())
        outcome = _improved(outcome, searcher, template, state, better, until, memory)
    return outcome


def _improved(
    best: SearchOutcome,
    searcher: Searcher,
    template: SASTemplate,
    state: tuple[AtomKey, ...],
    searches: Iterable[str],
    until: float,
    memory: int | None,
) -> SearchOutcome:
    """The best plan after searches for better ones: all of them, until one proves that there is
    none, or until the time is over."""
    for search in searches:
        while (left := until - time.monotonic()) > 0 and best.cost > 0:
            bounded = search.format(bound=best.cost)
            found = searcher.run(template, state, bounded, seconds=left, memory=memory)
            if found.kind == "unsolvable":
                return best
            if found.kind != "plan" or found.cost >= best.cost:
                break
            best = found
    return best
