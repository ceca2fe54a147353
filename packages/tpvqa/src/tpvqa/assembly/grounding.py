"""The task of a trial, grounded in the time that is allowed."""

from pathlib import Path

from tpvqa.config import PlannerConfig
from tpvqa.errors import GroundingTimedOut
from tpvqa.pddl import Task, load_task

LONG = 300.0
"""Seconds that grounding may take where planning may take what it usually may."""


def grounded(domain: Path | str, problem: Path | str, planner: PlannerConfig) -> Task:
    """Read and ground a task.

    What a planner is allowed unless somebody says otherwise is meant for plans, of which a trial
    needs many: a task is grounded once.

    Raises:
        GroundingTimedOut: It took longer than one call of the planner may.
        TpvqaError: As `load_task` does.
    """
    usual = planner.timeout == PlannerConfig().timeout
    try:
        return load_task(domain, problem, timeout=LONG if usual else planner.timeout)
    except GroundingTimedOut as error:
        raise error.by("--planning-timeout") from None
