"""The toys' table as a world: physics lets skills succeed or fail, and the robot's eyes see it."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Self

from tpvqa.chance import chance
from tpvqa.errors import WorldError
from tpvqa.pddl import Action, State, Task
from tpvqa_robots.grasps.antipodal import antipodal
from tpvqa_robots.grasps.methods import Method, said
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.physical import PhysicalWorld, Pixels
from tpvqa_robots.skills.recognising import RecognisingRobot
from tpvqa_robots.skills.simulated import SimulatedRobot
from tpvqa_robots.toys.cameras import Cameras
from tpvqa_robots.toys.machine import Machine
from tpvqa_robots.toys.scans import SCANS
from tpvqa_robots.toys.scene import ELSEWHERE, FAR, SPOTS, build
from tpvqa_robots.toys.things import Spot
from tpvqa_robots.toys.truth import CONTAINERS, KNOWN, true_state
from tpvqa_robots.truth import atoms_of, see_known

SLIPS_AFTER = 0.25
"""Seconds after a turn begins at which the fingers give way, where they do."""
PLACES = ("table", "goal_area", "floor")
MOST = 2
"""Toys that stand on the table, at most."""
MOVED, TURNED = 0.02, 0.4
"""How far things stand from where they usually do, metres and radians at most."""


class ToysWorld(PhysicalWorld):
    """A table with toys, two containers and a goal area, before a robot on a base that turns.

    Args:
        task: One with the predicates of `collect_toys`.
        mishaps: What is made to go wrong.
        grasps: How the robot finds grasps.
        seed: With `episode`, see `tpvqa.chance`.
        episode: The same.
        on_tick: Told after every 20 ms of simulated time: for a film.

    Raises:
        MissingExtraError: MuJoCo or robosuite is not installed.
        WorldError: There is no graphics library, or the task is about something else.
    """

    name = "toys"

    def __init__(
        self,
        task: Task,
        *,
        mishaps: Mishaps | None = None,
        grasps: Method = antipodal,
        seed: int = 0,
        episode: int = 0,
        on_tick: Callable[[Self], None] | None = None,
    ):
        see_known(task, KNOWN, world=self.name, example="collect_toys")
        self._things = _things_of(task)
        wrong = Mishaps(appendix=True) if mishaps is None else mishaps
        super().__init__(
            task,
            atoms_of(task, KNOWN),
            mishaps=wrong,
            grasps=grasps,
            seed=seed,
            episode=episode,
            on_tick=None if on_tick is None else lambda: on_tick(self),
        )

    @classmethod
    def from_spec(cls, arguments: str, *, task: Task, seed: int, episode: int) -> "ToysWorld":
        """The world of `toys`, `toys:appendix` or `toys:slip=0.2:bad=0.1:noise=1:far=1`.

        `grasps=ggcnn` may be among the words.

        Raises:
            PluginError: The words are not understood.
        """
        grasps, words = said(arguments, cls.name)
        mishaps = Mishaps.read(words)
        return cls(task, mishaps=mishaps, grasps=grasps, seed=seed, episode=episode)

    def room(self, seed: int, episode: int) -> Any:
        """The table, with things near where they usually stand, or a toy far from it."""
        spots = _spots(self._things, seed, episode, far=self.drawn.is_far())
        return build(spots, drives=self._mishaps.far > 0)

    def robot_of(self, machine: Machine, cameras: Cameras) -> SimulatedRobot:
        """The robot, which knows the things' colours; where they do not tell them apart, things."""
        bad, grasps = self.drawn.is_bad, self.grasps
        if not set(self._things) & set(SCANS):
            return SimulatedRobot(machine, cameras, bad_grasp=bad, grasps=grasps)
        known = (*self._things, "goal_area")
        return RecognisingRobot(machine, cameras, things=known, bad_grasp=bad, grasps=grasps)

    def true(self, machine: Machine, pixels: Pixels) -> State:
        """See `toys.truth`."""
        return true_state(machine.model, machine.data, pixels(), self._atoms)

    def beginning(self, action: Action) -> None:
        """A container may slip while the base turns with it."""
        held = self.robot.held if action.name == "find" else None
        if held is not None and held.thing in CONTAINERS and self.drawn.slips():
            self.slip_after(SLIPS_AFTER)


def _things_of(task: Task) -> tuple[str, ...]:
    """What a task has on the table: two containers, and one or two toys."""
    named = [name for name in task.objects if name not in PLACES]
    known = (*SPOTS, *SCANS)
    strange = [name for name in named if name not in known]
    if strange:
        raise WorldError(
            f"There is no {strange[0]!r} on the toys' table; there are {', '.join(known)}."
        )
    toys = [name for name in named if name not in CONTAINERS]
    if len(toys) > MOST:
        raise WorldError(
            f"The toys' table has room for {MOST} toys; the task has {', '.join(toys)}."
        )
    return (*CONTAINERS, *toys)


def _spots(things: Sequence[str], seed: int, episode: int, *, far: bool) -> Mapping[str, Spot]:
    drawn, usual = chance(seed, episode, "spots"), [*SPOTS.values(), ELSEWHERE]
    if far:
        usual[len(CONTAINERS)] = FAR
    found = {}
    for name, spot in zip(things, usual, strict=False):
        x, y = (v + drawn.uniform(-MOVED, MOVED) for v in (spot.x, spot.y))
        found[name] = Spot(x, y, spot.yaw + drawn.uniform(-TURNED, TURNED))
    return found
