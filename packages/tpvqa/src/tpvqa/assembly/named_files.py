"""The files that a configuration names, read without a trial."""

from pathlib import Path

from tpvqa.assembly.grounding import grounded
from tpvqa.assembly.told import read_told
from tpvqa.belief.calibrating.risk import RiskCalibration
from tpvqa.belief.filtering.priors import load_priors
from tpvqa.config import TrialConfig
from tpvqa.errors import TpvqaError
from tpvqa.pddl.state_file import read_state
from tpvqa.questions import QuestionBook
from tpvqa.tasks import domain_and_problem, find_task
from tpvqa.vlm.prompt import load_prompt
from tpvqa.worlds.world_file import load_world_file


def see_files(config: TrialConfig) -> None:
    """See that the files of a configuration can be used, as a trial of it would.

    Args:
        config: The configuration; where it names no task, what is about one is not looked at.

    Raises:
        TpvqaError: The task is not there, or a file cannot be read.
    """
    read_told(config.monitor, None, None)
    if config.monitor.risk_file is not None:
        RiskCalibration.load(Path(config.monitor.risk_file))
    if config.vlm.prompt is not None:
        load_prompt(Path(config.vlm.prompt))
    named = config.task
    files = None if named.name is None else find_task(named.name)
    own = domain_and_problem(named.domain, named.problem)
    domain, problem = own if files is None else (files.domain, files.problem)
    if domain is None and problem is None:
        return
    if domain is None or problem is None:
        raise TpvqaError("Name a shipped task, or give both --domain and --problem.")
    task = grounded(domain, problem, config.planner)
    QuestionBook.load(named.questions or (files.questions if files else None), task)
    load_world_file(named.world_file or (files.world if files else None), task)
    load_priors(task, config.start.priors, config.start.what)
    if config.simulation is not None and config.simulation.true_start is not None:
        read_state(Path(config.simulation.true_start), task)
