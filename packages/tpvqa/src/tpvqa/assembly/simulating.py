"""The true state of a trial's world, and the faults that its configuration names."""

from collections.abc import Sequence
from pathlib import Path

from tpvqa.belief.filtering.priors import Priors
from tpvqa.belief.filtering.starts import drawn_start
from tpvqa.belief.states.memory import Undoing
from tpvqa.belief.states.undoing import BackToBefore
from tpvqa.config import SimulationConfig, TrialConfig
from tpvqa.events import Started
from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.pddl.state_file import read_state
from tpvqa.planning import Plan, Planner
from tpvqa.plugins import Kind, load_spec
from tpvqa.worlds.capabilities import is_simulated
from tpvqa.worlds.dead import Dead
from tpvqa.worlds.elsewhere import elsewhere
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.world_file import WorldRules


def simulate(
    world: str,
    task: Task,
    rules: WorldRules,
    config: TrialConfig,
    planner: Planner,
    begun_as: Started | None,
    priors: Priors,
) -> Simulation | None:
    """The simulation of a trial; None where the world keeps no true state.

    Where no world file says what comes undone, an undone fact gives way to what held before it, as
    the belief takes it to.

    Args:
        world: The specification of the world.
        task: The task.
        rules: What its world file says.
        config: What the trial is.
        planner: Tells what a plan handles, and whether there is one.
        begun_as: The first event, where the trial was begun before: it says the true first state.
        priors: How probable facts are at first, where the problem does not say.

    Raises:
        TpvqaError: A skill or a first state that is named does not fit the task.
    """
    if not is_simulated(load_spec(Kind.WORLD, world)):
        return None
    faults = config.simulation or SimulationConfig()
    if begun_as is not None:
        told = begun_as.true_start
        start = None if told is None else frozenset(map(Atom.parse, told))
    else:
        start = _start(task, config, faults, planner)
        if start is None:
            start = drawn_start(task, priors, rules, config.seed, config.episode)
    return Simulation(
        task,
        rules,
        **faults.model_dump(exclude={"dead", "true_start", "elsewhere"}),
        dead=Dead.parse(faults.dead, task),
        undoing=undoings(task, rules),
        start=start,
        seed=config.seed,
        episode=config.episode,
    )


def undoings(task: Task, rules: WorldRules) -> Sequence[Undoing]:
    """What can come undone: what the world file says, or else what held before comes back."""
    return () if rules.nothing_undone else rules.undo or (BackToBefore(task),)


def _start(
    task: Task, config: TrialConfig, faults: SimulationConfig, planner: Planner
) -> State | None:
    """The true state at first; None for that of the problem."""
    if faults.true_start is not None:
        return read_state(Path(faults.true_start), task)
    if not faults.elsewhere:
        return None

    def plan(state: State) -> Sequence[Action] | None:
        found = planner.plan(task, state, timeout=config.planner.timeout)
        return found.actions if isinstance(found, Plan) else None

    return elsewhere(task, faults.elsewhere, plan=plan, seed=config.seed, episode=config.episode)
