"""Settings of a simulated world that were given and change nothing."""

from collections.abc import Collection, Iterator
from random import Random
from typing import TYPE_CHECKING

from tpvqa.config.layers import Key, settings

if TYPE_CHECKING:
    from tpvqa.assembly import Trial
    from tpvqa.pddl import Atom
    from tpvqa.pddl.pattern import Pattern
    from tpvqa.worlds.simulation import Simulation

_OF_CHANCE = ("failure", "disturbance", "spontaneous", "moved", "redo")
"""Settings that a script takes the place of."""


def without_effect(trial: "Trial", given: Collection[Key]) -> list[str]:
    """What to know of settings that change nothing in this trial.

    Args:
        trial: Ready to run.
        given: Where the settings stand that were given on the command line or in a file.
    """
    options = {each.key: each.option for each in settings()}
    named = [name for part, *rest in sorted(given) if part == "simulation" for name in rest]
    simulation = trial.simulation
    notices = []
    for name in named:
        if getattr(trial.config.simulation, name, None) is None:  # as a file of defaults has it
            continue
        why = _why(trial, simulation, name)
        if why:
            notices.append(f"{options['simulation', name]} has no effect: {why}")
    if simulation is not None and trial.config.task.name is None:
        notices += _idle_rules(trial, simulation)
    return notices


def _why(trial: "Trial", simulation: "Simulation | None", name: str) -> str:
    """Why a setting changes nothing; empty where it does."""
    from tpvqa.plugins import split
    from tpvqa.worlds.people import somebody_moves

    if simulation is None:
        return f"the world {trial.world_spec} is not simulated"
    if split(trial.world_spec)[0] == "scripted" and name in _OF_CHANCE:
        return "a script says what goes wrong in the scripted world"
    if name in ("disturbance", "spontaneous") and getattr(simulation, name) > 0:
        if trial.rules.nothing_undone:
            return f"{trial.world_file} says that nothing can be undone"
        if name == "disturbance" and simulation.failure == 0:
            return "only a failed action disturbs something, and --failure is 0"
        if not _can_be_undone(trial, simulation):
            return "nothing that the plan achieves can be undone"
    if name == "moved" and not somebody_moves(trial.task, simulation.state, Random(0)):
        return "nothing can be put elsewhere without changing more than its place"
    if name == "true_start" and simulation.start == trial.task.init:
        return "the state is that of the problem"
    return ""


def _can_be_undone(trial: "Trial", simulation: "Simulation") -> bool:
    """Whether a disturbance could undo anything after any action of the plan."""
    from tpvqa.planning import Plan
    from tpvqa.worlds.simulation import Simulation

    found = trial.parts.planner.plan(trial.task, timeout=trial.config.planner.timeout)
    faultless = Simulation(
        trial.task, simulation.rules, failure=0, disturbance=0, undoing=simulation.undoing
    )
    for action in found.actions if isinstance(found, Plan) else ():
        faultless.execute(action)
        if faultless.undoable():
            return True
    return False


def _idle_rules(trial: "Trial", simulation: "Simulation") -> Iterator[str]:
    """Rules of a world file that speak of nothing that can be true."""
    task = trial.task
    known = task.atoms() | task.init | simulation.start
    added = {
        pattern.predicate
        for rule in trial.rules.undo
        for outcome in rule.outcomes
        for pattern in outcome.add
    }

    def idle(pattern: "Pattern") -> bool:
        def matches(atom: "Atom") -> bool:
            return pattern.match(atom, {}, task) is not None

        return pattern.predicate not in added and not any(map(matches, known))

    for rule in trial.rules.undo:
        if idle(rule.fact):
            yield f"{trial.world_file}: {rule.fact} can never be true here, so it is never undone"
    for rebinding in trial.rules.rebind:
        if idle(rebinding.to):
            yield (
                f"{trial.world_file}: {rebinding.to} can never be true here, so "
                f"{rebinding.argument} of {rebinding.action} is as planned"
            )
