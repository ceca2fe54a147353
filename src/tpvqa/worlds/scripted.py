"""A world whose faults are written down: to try a domain, and to tell a story exactly.

A script is a YAML file. Every action does what its effects say, but for those named in it:

    script:
      - action: (pick_up blue_container table)   # attempt 1 unless `attempt` says otherwise
        then: {add: [(on blue_container floor)], delete: [(in_hand blue_container)]}
      - action: (pick_up toy_eggplant table)
        fails: true
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from tpvqa.errors import WorldError
from tpvqa.pddl import Action, Atom
from tpvqa.worlds.simulation import Outcome, Simulation
from tpvqa.worlds.symbolic import SymbolicWorld


@dataclass(frozen=True, slots=True)
class ScriptedFault:
    """What befalls one attempt of one action.

    Attributes:
        fails: Whether the action's own effects stay out.
        add: Facts that become true after it.
        delete: Facts that end after it.
    """

    fails: bool
    add: frozenset[Atom]
    delete: frozenset[Atom]


Script = Mapping[tuple[str, int], ScriptedFault]


class _ScriptedSimulation(Simulation):
    """The true state, changed as the script says instead of by chance."""

    def __init__(self, simulation: Simulation, script: Script):
        super().__init__(simulation.task, failure=0.0, disturbance=0.0)
        self._script = script

    def execute(self, action: Action) -> Outcome:
        """Try an action on the true state."""
        fault = self._script.get((action.pddl(), self.attempts[action.pddl()] + 1))
        before = self.state
        if fault is None or not fault.fails:
            outcome = super().execute(action)
        else:
            self.attempts[action.pddl()] += 1
            outcome = Outcome(False, "the script says so", None, "", before, before)
        if fault is None:
            return outcome
        self._become((self.state - fault.delete) | fault.add)
        gone = next(iter(sorted(fault.delete)), None)
        return Outcome(
            outcome.succeeded, outcome.reason, gone, "the script says so", before, self.state
        )


class ScriptedWorld(SymbolicWorld):
    """A symbolic world with scripted faults.

    Args:
        simulation: Gives the task; its chances are not used.
        script: What befalls which attempt (counted from 1) of which action.
    """

    def __init__(self, simulation: Simulation, script: Script):
        super().__init__(_ScriptedSimulation(simulation, script))

    @classmethod
    def from_spec(cls, arguments: str, *, simulation: Simulation) -> "ScriptedWorld":
        """Make it from `scripted:FILE`; without a file every action works.

        Raises:
            WorldError: The file cannot be read or is not a script.
        """
        return cls(simulation, load_script(Path(arguments)) if arguments else {})


def load_script(path: Path) -> Script:
    """Read a script.

    Raises:
        WorldError: The file is missing or broken; the message names the place.
    """
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise WorldError(f"{path}: cannot be read ({error.strerror})") from error
    except yaml.YAMLError as error:
        raise WorldError(f"{path}: not valid YAML: {error}") from error
    entries = document.get("script") if isinstance(document, dict) else None
    if not isinstance(entries, list):
        raise WorldError(f"{path}: expected a list under `script:`")
    script: dict[tuple[str, int], ScriptedFault] = {}
    for number, entry in enumerate(entries, 1):
        try:
            key, fault = _fault(entry)
        except (TypeError, ValueError) as error:
            raise WorldError(f"{path}: entry {number} under `script`: {error}") from error
        script[key] = fault
    return script


def _fault(entry: Any) -> tuple[tuple[str, int], ScriptedFault]:
    known = {"action", "attempt", "fails", "then"}
    if not isinstance(entry, dict) or not isinstance(entry.get("action"), str):
        raise TypeError("expected `action: (name object …)`")
    if not set(entry) <= known:
        raise ValueError(f"unknown field; known: {', '.join(sorted(known))}")
    then = entry.get("then") or {}
    if not isinstance(then, dict) or not set(then) <= {"add", "delete"}:
        raise ValueError("`then` has only the lists `add` and `delete`")
    attempt = entry.get("attempt", 1)
    if not isinstance(attempt, int) or attempt < 1:
        raise ValueError(f"`attempt` is {attempt!r}; attempts count from 1")
    return (Atom.parse(entry["action"]).pddl(), attempt), ScriptedFault(
        bool(entry.get("fails", False)),
        frozenset(map(Atom.parse, then.get("add") or ())),
        frozenset(map(Atom.parse, then.get("delete") or ())),
    )
