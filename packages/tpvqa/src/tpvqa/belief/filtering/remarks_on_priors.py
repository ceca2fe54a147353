"""What a file of priors says in vain, as something else decides it, or not as it is taken."""

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, product
from math import fsum
from typing import Any

from tpvqa.belief.filtering.priors import ROUNDED, Priors
from tpvqa.belief.filtering.starts import opened
from tpvqa.pddl import Atom, State, Task
from tpvqa.pddl.pattern import Pattern

_LEAST = 0.01
"""A fact that is at least so probable holds in some of the states that are looked at."""
_LEFT_OPEN = "Where it may hold at first, write (unknown {}) into the problem's (:init …)."
_LISTED = 20_000
"""Facts that are looked at for one form."""


@dataclass(frozen=True, slots=True)
class Remark:
    """What is to be known of a line of priors.

    Attributes:
        says: What has no effect, or another one; a sentence without its full stop.
        remedy: What to do, a sentence.
        line: Where it stands; None where all of the file is meant.
    """

    says: str
    remedy: str
    line: int | None = None


def remarks(task: Task, priors: Priors, undo: Sequence[Any] = ()) -> Iterator[Remark]:
    """What has no effect, and what is not taken as it stands.

    Args:
        task: The task, as its problem tells it.
        priors: The priors.
        undo: What disturbances can undo, as a world file says.

    Raises:
        BeliefError: No state is possible.
        PlannerError: The worker could not ground the task.
    """
    if priors.empty:
        yield Remark(
            "the file says nothing of how probable facts are", "Leave it out, or write some."
        )
    if not priors.facts:
        return
    from tpvqa.belief.filtering.first import Prior  # late, as all that it needs takes a while

    task = opened(task, priors)
    known = sorted(task.atoms() | task.init)
    stated = priors.stated(known, task)
    prior = Prior(task, priors, undo)
    # Where there are more states than are looked at, what none of them shows may yet be.
    states = [state for state, _ in prior.states()] if prior.covered() else []
    can_hold = frozenset(known)
    yield from _scaled_up(task, priors, can_hold)
    deciding = priors.deciding(known, task)
    shared = _shared_out(task, priors)
    for nth, (pattern, probability) in enumerate(priors.facts):
        line = priors.lines[nth] if priors.lines else None
        form = f"{pattern}: {probability:g} has no effect"
        fitting = [atom for atom in known if pattern.match(atom, {}, task) is not None]
        own = [atom for atom in fitting if deciding[atom] == nth]
        missing = [atom for atom in _only_at_first(pattern, task) if atom not in can_hold]
        if missing and not fitting:
            yield Remark(
                f"{form}: the problem does not say {missing[0].pddl()}, and no action brings it "
                "about",
                _LEFT_OPEN.format(missing[0].pddl()),
                line,
            )
        elif not fitting:
            yield Remark(f"{form}: no fact of this form can ever hold", "Leave it out.", line)
        elif missing and not priors.nothing_known:
            yield Remark(
                f"{pattern}: {probability:g} has no effect on {missing[0].pddl()}"
                f"{' and others' if len(missing) > 1 else ''}: the problem does not say so, and no "
                "action brings it about",
                _LEFT_OPEN.format(missing[0].pddl()),
                line,
            )
        elif not own:
            later = "what follows says otherwise of every fact of this form"
            yield Remark(f"{form}: {later}", "Of several that fit the last one counts.", line)
        elif nth in shared:
            yield Remark(
                f"{pattern}: {probability:g} is shared out: of facts that this fits one holds at "
                f"most, and with what else is said of them that makes {shared[nth]:g}",
                "For each to be as probable as is said, make them add up to 1 at most.",
                line,
            )
        elif not priors.nothing_known and all(_said(each, task, stated) for each in own):
            yield Remark(f"{form}: the problem says so for certain", "Leave it out.", line)
        elif states and all(_decided(atom, probability, states) for atom in own):
            held = "holds" if own[0] in states[0] else "does not hold"
            yield Remark(
                f"{form}: with all that the problem states it {held} for certain",
                "Leave it out, or have the problem leave open ((unknown …) in its :init), or the "
                "priors say, what else may be the case instead.",
                line,
            )


def _only_at_first(pattern: Pattern, task: Task) -> Iterator[Atom]:
    """The facts that a form fits, of a predicate that no action brings about."""
    effects = (effect.literal for schema in task.schemas for effect in schema.effects)
    if any(each.positive and each.predicate == pattern.predicate for each in effects):
        return
    kinds = task.predicates[pattern.predicate]
    objects = ([obj for obj in task.objects if task.is_a(obj, kind)] for kind in kinds)
    for arguments in islice(product(*objects), _LISTED):
        atom = Atom(pattern.predicate, arguments)
        if pattern.match(atom, {}, task) is not None:
            yield atom


def _shared_out(task: Task, priors: Priors) -> dict[int, float]:
    """The forms that fit several facts of a group which are too probable together, and how
    probable these are."""
    found: dict[int, float] = {}
    for deciding in priors.groups(task):
        total = fsum(priors.facts[nth][1] for nth in deciding.values())
        if total > 1 + ROUNDED:
            (widest, _), *_ = Counter(deciding.values()).most_common(1)
            found[widest] = max(total, found.get(widest, 0))
    return found


def _scaled_up(task: Task, priors: Priors, possible: State) -> Iterator[Remark]:
    """Facts of which one holds, all of which have a probability, and which are together less
    probable than 1."""
    for group in (*(g.atoms for g in task.mutex_groups if g.exactly_one), *task.oneof):
        deciding = priors.deciding(sorted(group & possible), task)
        total = fsum(priors.facts[nth][1] for nth in deciding.values())
        if len(deciding) < 2 or deciding.keys() < group & possible or total >= 1 - ROUNDED:
            continue
        named = ", ".join(atom.pddl() for atom in [*deciding][:3])
        taken = "each is scaled up" if total else "all are taken to be as probable"
        yield Remark(
            f"one of {named}{' …' if len(deciding) > 3 else ''} holds, and together they are given "
            f"{total:g}: {taken}",
            "Make them add up to 1, or leave the one that the problem states to it.",
            priors.lines[max(deciding.values())] if priors.lines else None,
        )


def _said(atom: Atom, task: Task, stated: dict[Atom, float]) -> bool:
    """Whether priors say of a fact what the problem says of it."""
    if atom in task.left_open or stated[atom] != (atom in task.init):
        return False
    others: Collection[Atom] = frozenset().union(
        *(group.atoms for group in task.mutex_groups if atom in group.atoms)
    ) - {atom}
    return atom in task.init or not any(a in stated or a in task.left_open for a in others)


def _decided(atom: Atom, probability: float, states: Sequence[State]) -> bool:
    """Whether a fact that is said to be in doubt is none."""
    holding = sum(atom in state for state in states)
    return (holding == len(states) and probability <= 1 - _LEAST) or (
        holding == 0 and probability >= _LEAST
    )
