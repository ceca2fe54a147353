"""What a worker tells about a task: what its text says, and what grounding it reveals."""

from collections.abc import Mapping, Sequence
from hashlib import blake2b
from pathlib import Path
from typing import Any

from tpvqa.errors import GroundingTimedOut, PDDLError, PlannerError
from tpvqa.pddl.atoms import Atom, Literal, State
from tpvqa.pddl.ground import MutexGroup
from tpvqa.pddl.processes import WorkerTimedOut, ask_worker

MEMORY = 4096
"""The limit of a worker's memory in MiB, and that of a search's, where no other is given."""

Description = Mapping[str, Any]
"""The worker's reply, in the form that `tpvqa.pddl.worker.describing` gives it."""


def key_of(domain: str, problem: str) -> str:
    """Names a domain and a problem among all that a worker may know, by their texts."""
    digest = blake2b(digest_size=16)
    for text in (domain, problem):
        digest.update(text.encode() + b"\0")
    return digest.hexdigest()


def described(
    domain: str,
    problem: str,
    *,
    state: State | None = None,
    also: State = frozenset(),
    domain_path: Path | None = None,
    problem_path: Path | None = None,
    timeout: float | None = 300.0,
    memory: int | None = MEMORY,
) -> Description:
    """Let a worker read and ground a task.

    Args:
        domain: The text of the domain.
        problem: The text of the problem.
        state: The initial state; None for the problem's own.
        also: Facts that may hold at first besides.
        domain_path: What errors name.
        problem_path: The same.
        timeout: Seconds that it may take; None for no limit.
        memory: The limit of the worker's memory in MiB; None for none.

    Raises:
        PDDLError: The text cannot be read as PDDL.
        GroundingTimedOut: It took too long.
        PlannerError: Grounding failed.
    """
    try:
        reply = ask_worker(
            {
                "do": "describe",
                "init": None if state is None else to_lists(state),
                "also": to_lists(also),
                "grounding_memory": memory,
            },
            key=key_of(domain, problem),
            domain=domain,
            problem=problem,
            seconds=timeout,
        )
    except WorkerTimedOut:
        raise GroundingTimedOut(
            f"grounding the task took more than {timeout:g} s; make the problem smaller, or give "
            "it more time"
        ) from None
    if "error" in reply:
        message, part, line = reply["error"]
        path = problem_path if part == "problem" else domain_path
        raise PDDLError(message, file=path or f"({part})", line=line)
    if "outcome" in reply:
        reason = f"the task cannot be grounded: {reply['outcome']['reason']}"
        raise PlannerError(reason)
    description: Description = reply["task"]
    return description


def grounded_fields(description: Description, numbers: State | None = None) -> dict[str, Any]:
    """The fields of a `Task` that depend on its initial state.

    Args:
        description: The worker's reply.
        numbers: The facts that say values, of which the worker knows nothing; None for none.
    """
    return {
        "init": frozenset(map(_atom, description["init"])) | (numbers or frozenset()),
        "reachable_atoms": frozenset(map(_atom, description["atoms"])),
        "reachable_actions": tuple(map(tuple, description["ground_actions"])),
        "mutex_groups": tuple(
            MutexGroup(frozenset(map(_atom, atoms)), exactly_one)
            for atoms, exactly_one in description["mutex_groups"]
        ),
        "left_out": frozenset(description["left_out"]),
    }


def unsure_fields(description: Description) -> dict[str, Any]:
    """The fields of a `Task` that say what its problem leaves open."""
    return {
        "unknown": frozenset(map(_atom, description["unknown"])),
        "oneof": tuple(frozenset(map(_atom, group)) for group in description["oneof"]),
        "clauses": tuple(
            tuple(Literal(_atom(words), positive) for positive, words in clause)
            for clause in description["clauses"]
        ),
    }


def to_lists(state: State) -> list[list[str]]:
    """The atoms of a state as the worker takes them."""
    return [[atom.predicate, *atom.arguments] for atom in state]


def _atom(words: Sequence[str]) -> Atom:
    return Atom(words[0], tuple(words[1:]))
