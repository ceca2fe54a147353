"""The limit beside the monitors: who knows the true state after every action.

It plans with the planner of the trials, does the first action, and plans again from the true state
wherever that is not what the plan expects. No monitor is told the truth, so that this is none: it
acts in the trial's world itself. Its faults are those of the same episode under any monitor.
"""

from dataclasses import asdict

from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.stage import Stage, true_simulation
from tpvqa.config import TrialConfig
from tpvqa.pddl import Action, State
from tpvqa.planning import Plan, Planner
from tpvqa.worlds.simulation import Simulation
from tpvqa_experiments.abroad.parts import SEEING

ACTING = "tp"
"""The monitor of the trial whose world it acts in; it is never asked."""


def seeing(here: Stage, cell: Cell, common: TrialConfig, episode: int) -> EpisodeRow:
    """One episode of who sees all.

    Args:
        here: The stage of the cell's task.
        cell: Task, VLM, world and condition; its monitor does not matter.
        common: What all cells share.
        episode: Its number.

    Raises:
        TpvqaError: The trial cannot be made.
    """
    acting = Cell(cell.task, ACTING, cell.vlm, cell.world, cell.condition)
    config = acting.config(common, episode)
    row = {**asdict(cell), "monitor": SEEING, "seed": common.seed, "episode": episode}
    with here.trial(config) as trial:
        simulation = true_simulation(trial)
        first = _plan(trial.parts.planner, simulation, simulation.state, config.planner.timeout)
        if first is None:
            return EpisodeRow(**row, because="no plan")
        most = config.limits.actions_of(len(first))
        actions = failures = replans = 0
        plan: list[Action] | None = first
        while plan and actions < most:
            expected = simulation.task.apply(simulation.state, plan[0])
            outcome = simulation.execute(plan[0])
            actions += 1
            failures += not outcome.succeeded or outcome.undone is not None
            if simulation.state == expected:
                plan = plan[1:]
            elif simulation.state != outcome.before:
                replans += 1
                plan = _plan(
                    trial.parts.planner, simulation, simulation.state, config.planner.timeout
                )
        completed = simulation.task.goal_holds(simulation.state)
    return EpisodeRow(
        **row,
        completed=completed,
        because="goal" if completed else "limit of actions" if plan else "no plan",
        believed_goal=completed,
        actions=actions,
        failures=failures,
        replans=replans,
        first_plan=len(first),
    )


def _plan(
    planner: Planner, simulation: Simulation, state: State, timeout: float
) -> list[Action] | None:
    found = planner.plan(simulation.task, state, timeout=timeout)
    return list(found.actions) if isinstance(found, Plan) else None
