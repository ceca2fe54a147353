"""What is wrong with a file of priors."""

from collections.abc import Iterator
from pathlib import Path

from tpvqa.belief.filtering.priors import load_priors
from tpvqa.belief.filtering.remarks_on_priors import remarks
from tpvqa.checking.finding import Finding, Severity, of_error
from tpvqa.errors import BeliefError, PriorsError
from tpvqa.pddl import Task
from tpvqa.worlds.world_file import WorldRules


def of_priors(
    task: Task, path: Path | None, rules: WorldRules, start: str = "known"
) -> Iterator[Finding]:
    """What does not fit the task, contradicts itself, has no effect, or not what it says.

    Args:
        task: The task.
        path: The file of priors; None for none.
        rules: The world file's.
        start: What is known at first, as `tpvqa run --start` takes it.
    """
    if path is None:
        return
    file = str(path)
    try:
        for each in remarks(task, load_priors(task, path, start), rules.undo):
            yield Finding("priors", Severity.WARNING, each.says, each.remedy, file, each.line)
    except PriorsError as error:
        yield of_error("priors", error)
    except BeliefError as error:
        yield Finding("priors", Severity.ERROR, str(error), "", file)
