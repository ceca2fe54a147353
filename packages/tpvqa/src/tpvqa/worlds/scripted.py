"""A world whose faults are written down: to try a domain, and to tell a story exactly.

Every action does what its effects say, but for those that the script names.
"""

import logging
from pathlib import Path

from tpvqa.pddl import Action
from tpvqa.worlds.outcome import Failure, Outcome
from tpvqa.worlds.script_file import Script, load_script
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.symbolic import SymbolicWorld

_LOG = logging.getLogger(__name__)
_UNDOING = "the script says so"


class _ScriptedSimulation(Simulation):
    """The true state, changed as the script says instead of by chance."""

    def __init__(self, simulation: Simulation, script: Script):
        super().__init__(
            simulation.task,
            simulation.rules,
            failure=0.0,
            disturbance=0.0,
            seed=simulation.seed,
            episode=simulation.episode,
            dead=simulation.dead,
            start=simulation.start,
        )
        self._script = script

    def _tried(self, action: Action) -> Outcome:
        fault = self._script.get((action.pddl(), self.attempts[action.pddl()] + 1))
        before = self.state
        if fault is None or not fault.fails:
            outcome = super()._tried(action)
        else:
            self.attempts[action.pddl()] += 1
            outcome = Outcome(Failure.SCRIPT, None, "", before, before)
        if fault is None:
            return outcome
        self.become((self.state - fault.delete) | fault.add)
        gone = next(iter(sorted(fault.delete)), None)
        return Outcome(outcome.failure, gone, _UNDOING, before, self.state)


class ScriptedWorld(SymbolicWorld):
    """A symbolic world with scripted faults.

    Args:
        simulation: Gives the task and its rules; its chances are not used.
        script: What befalls which attempt (counted from 1) of which action.
    """

    def __init__(self, simulation: Simulation, script: Script):
        super().__init__(_ScriptedSimulation(simulation, script))
        self._script = script

    @classmethod
    def from_spec(
        cls, arguments: str, *, simulation: Simulation, script_file: Path | None = None
    ) -> "ScriptedWorld":
        """Make it from `scripted:FILE`; without a file the shipped task's own script counts.

        Where there is none either, every action works.

        Raises:
            WorldFileError: The file cannot be read or is not a script for the task.
        """
        file = Path(arguments) if arguments else script_file
        return cls(simulation, {} if file is None else load_script(file, simulation.task))

    def close(self) -> None:
        """Say which entries of the script never came to pass."""
        attempts = self.simulation.attempts
        script, self._script = self._script, {}
        for (action, attempt), fault in script.items() if attempts else ():
            if attempts[action] < attempt:
                tried = f"was tried {attempts[action]} times" if attempts[action] else "never came"
                _LOG.warning(
                    "%s: attempt %d of %s did not take place: the action %s",
                    *(fault.place, attempt, action, tried),
                )
