"""The task of a trial, grounded in the time that the trial allows its planner."""

from pathlib import Path

from tpvqa.config import PlannerConfig
from tpvqa.errors import GroundingTimedOut
from tpvqa.pddl import Task, load_task


def grounded(domain: Path | str, problem: Path | str, planner: PlannerConfig) -> Task:
    """Read and ground a task.

    Raises:
        GroundingTimedOut: It took longer than one call of the planner may.
        TpvqaError: As `load_task` does.
    """
    try:
        return load_task(domain, problem, timeout=planner.timeout)
    except GroundingTimedOut as error:
        raise error.by("--planning-timeout") from None
