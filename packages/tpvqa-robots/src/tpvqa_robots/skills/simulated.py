"""The simulated robot: its skills find, pick up and place, on what its camera and joints tell."""

import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from itertools import islice
from typing import Any

import numpy as np

from tpvqa.errors import UnknownNameError
from tpvqa.observation import Depth, LateDepth, LateFrame, Observation, SensedFact
from tpvqa.pddl import Action, Atom
from tpvqa.worlds import Execution, Report
from tpvqa_robots.grasps.antipodal import antipodal
from tpvqa_robots.grasps.grasp import Grasp
from tpvqa_robots.grasps.methods import Method
from tpvqa_robots.skills.driving import AXIS, Stance, in_reach, looking, stance_before
from tpvqa_robots.skills.kinematics import Grip, Kinematics, OutOfReachError
from tpvqa_robots.skills.motions import Guard, Motions, NotThereError, Stopped, Told
from tpvqa_robots.skills.seeing import HUES, Seen, see
from tpvqa_robots.toys.cameras import CAMERAS, OVERHEAD, Cameras, Shot
from tpvqa_robots.toys.machine import EMPTY, Machine
from tpvqa_robots.toys.room import TABLE

CARRY = Grip(0.36, 0.0, 0.98, np.pi / 2)
"""Where the gripper is while the base turns: before the table's edge, above its top."""
START = np.array([-0.381, -1.951, 1.988, -1.608, -1.571, -1.952])
"""Joints near `CARRY`, from which the solver starts."""
NEAR = 0.06
"""Radians off the middle at which a thing is near enough for the arm."""
ABOVE = 0.14
"""Metres above a grasp from which the gripper comes straight down."""
QUALITY = 92
"""Of the JPEG pictures."""
WENT = 0.03
"""Metres from which on the base is said to have driven."""
SURE = 0.98
"""How sure the gripper is of that."""
TRIES = 12
"""Grasps that are looked at for one that the arm can reach."""
UNLIKE = 0.012, 0.3
"""Metres or radians by which they differ from each other."""
HIGH = 0.005
"""Metres above where it stood at which a thing is let go."""
INTO = 0.045
"""Metres above a container's rim at which a thing is let go into it."""


Skill = Callable[[tuple[str, ...], Guard, Told], str]
"""Carries out an action with such arguments, and tells in words what came of it."""


class SkillError(Exception):
    """A skill cannot go on; its message is for people."""


@dataclass(frozen=True, slots=True)
class Held:
    """What the robot believes to carry, and how it took it.

    Attributes:
        thing: Its name.
        aside: From the grip to the thing's middle, metres, along x and y of the gripper.
        above: Of the grip over the table when it was taken, metres.
    """

    thing: str
    aside: tuple[float, float]
    above: float


class SimulatedRobot:
    """A robot behind `skills.protocol.Robot` on the toys' table.

    It knows where the table is and how it is built itself; where things are it sees, and whether
    it holds something its finger joints tell.

    Args:
        machine: Its drives.
        cameras: Its eyes.
        bad_grasp: Tells whether a grasp of a thing is to go wrong: it is then made 8 cm beside.
        grasps: How grasps are found.
    """

    def __init__(
        self,
        machine: Machine,
        cameras: Cameras,
        *,
        bad_grasp: Callable[[str], bool] = lambda thing: False,
        grasps: Method = antipodal,
    ):
        self.machine, self.cameras = machine, cameras
        self._bad_grasp, self._grasps = bad_grasp, grasps
        self._kinematics = Kinematics(
            machine.model, machine.qpos, machine.dofs, stance=lambda: self.stance
        )
        self._motions = Motions(machine, self._kinematics)
        self._lock = threading.Lock()
        self._shots = 0
        self.held: Held | None = None
        self.shut = False
        self.skills: Mapping[str, Skill] = {
            "find": self._find,
            "pick_up": self._pick_up,
            "place": self._place,
        }

    def begin(self) -> None:
        """Bring the arm where it carries, and let things come to rest."""
        self.machine.begin(self._kinematics.solve(CARRY, START))
        self._motions.wait(0.4)

    def perform(
        self,
        action: Action,
        *,
        deadline: float,
        cancelled: threading.Event,
        feedback: Callable[[str], None],
    ) -> Execution:
        """Carry out an action; see `Robot.perform`."""
        skill = self.skills.get(action.name)
        if skill is None:
            message = f"no skill {action.name!r}; there are {', '.join(self.skills)}"
            return Execution(Report.UNAVAILABLE, 0.0, message)
        with self._lock:
            start = self.machine.time
            guard = Guard(start + deadline, cancelled)
            try:
                report, message = self._done(skill, action, guard, feedback)
            except Stopped as stopped:
                self._motions.stop()
                report, message = stopped.report, "the arm stands where it was stopped"
            seconds = self.machine.time - start
            return Execution(report, seconds, message, self.sensed())

    def _done(
        self, skill: Skill, action: Action, guard: Guard, feedback: Told
    ) -> tuple[Report, str]:
        """How a skill ends; what failed is left, which may be stopped as well."""
        try:
            return Report.DONE, skill(action.arguments, guard, feedback)
        except (SkillError, NotThereError) as error:
            try:
                self._retreat(guard)
            except SkillError as stuck:
                return Report.FAILED, f"{error}; {stuck}"
            return Report.FAILED, str(error)

    def look(self, view: str = OVERHEAD) -> Observation:
        """A picture with depth of one of the robot's own cameras.

        Raises:
            UnknownNameError: It has no such camera.
        """
        if view not in CAMERAS:
            raise UnknownNameError("view", view, tuple(CAMERAS))
        with self.machine.lock:
            shot, now, facts = self._shot(view), self.machine.time, self.sensed()
        frame = LateFrame(
            id=view,
            view=view,
            data=lambda: _jpeg(shot.rgb),
            source="toys",
            stamp=now,
            intrinsics=shot.intrinsics,
            depth=LateDepth(lambda: Depth.from_metres(shot.depth).data),
        )
        return Observation(time=now, frames={view: frame}, facts=facts)

    def stop(self) -> None:
        """Have the arm stand still; a skill that runs ends as cancelled."""
        self._motions.halted.set()
        with self._lock:
            self._motions.stop()
            self._motions.halted.clear()

    def state(self) -> Mapping[str, float]:
        """All joints, radians, and the gripper's opening, metres."""
        return self.machine.joints()

    @property
    def stance(self) -> Stance:
        """Where the base stands, by its wheels."""
        return Stance(*self.machine.place, self.machine.yaw)

    @property
    def closed_on_something(self) -> bool:
        """Whether the fingers are shut and something keeps them apart."""
        return self.shut and self.machine.width > EMPTY

    def sensed(self) -> tuple[SensedFact, ...]:
        """What the gripper feels: whether the hand is empty."""
        return (SensedFact(Atom("hand_empty"), 1 - SURE if self.closed_on_something else SURE),)

    def snapshot(self) -> Mapping[str, Any]:
        """What the robot remembers, as JSON."""
        held = self.held
        return {
            "held": None if held is None else [held.thing, *held.aside, held.above],
            "shut": self.shut,
            "shots": self._shots,
        }

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave."""
        held = snapshot["held"]
        self.held = None if held is None else Held(held[0], (held[1], held[2]), held[3])
        self.shut, self._shots = snapshot["shut"], snapshot["shots"]

    def _shot(self, view: str = OVERHEAD) -> Shot:
        self._shots += 1
        return self.cameras.shot(self.machine.data, view, self._shots)

    def _see(self, thing: str) -> Seen | None:
        return self._seen(self._shot(), thing)

    def _seen(self, shot: Shot, thing: str) -> Seen | None:
        """Where a thing is in a picture."""
        return see(shot, thing, table=TABLE) if self._knows(thing) else None

    def _knows(self, thing: str) -> bool:
        """Whether it is known how a thing looks."""
        return thing in HUES

    def _find(self, args: tuple[str, ...], guard: Guard, feedback: Told) -> str:
        thing = args[0]
        if not self._knows(thing):
            raise SkillError(f"what {thing} looks like is not known")
        self._retreat(guard)
        began = self.machine.place
        for stance in looking(self.stance, drives=self.machine.drives):
            feedback(f"looking for {thing}")
            self._motions.drive(stance, guard)
            seen = self._see(thing)
            if seen is not None and self.machine.drives and not in_reach(seen.x, seen.y):
                feedback(f"driving to {thing}")
                self._motions.drive(stance_before(seen.x, seen.y, self.stance), guard)
                seen = self._see(thing)
            if seen is None:
                continue
            drove = float(np.hypot(*np.subtract(self.machine.place, began)))
            for _ in range(3):
                off = float(np.arctan2(seen.y, seen.x - AXIS))
                if abs(off) < NEAR and not seen.cut:
                    break
                feedback(f"turning to {thing}")
                self._motions.turn(self.machine.yaw + off, guard)
                seen = self._see(thing) or seen
            went = f" after {drove:.2f} m" if drove > WENT else ""
            return f"{thing} is in sight{went}"
        raise SkillError(f"{thing} is not in sight anywhere")

    def _pick_up(self, args: tuple[str, ...], guard: Guard, feedback: Told) -> str:
        thing = args[0]
        if self.closed_on_something:
            raise SkillError("something is in the hand already")
        self._retreat(guard)
        shot = self._shot()
        seen = self._seen(shot, thing)
        if seen is None:
            raise SkillError(f"{thing} is not in sight")
        feedback(f"looking for a grasp of {thing}")
        grasp = self._reachable(shot, seen, guard)
        feedback(f"grasping {thing}")
        aimed = _grip(grasp)
        if self._bad_grasp(thing):
            aimed = aimed.at(
                x=aimed.x + 0.08 * np.sin(aimed.angle), y=aimed.y - 0.08 * np.cos(aimed.angle)
            )
        self._go(aimed.at(z=aimed.z + ABOVE), guard)
        self._go(aimed, guard)
        self._motions.fingers(guard, shut=True)
        self.shut = True
        if self.closed_on_something:
            c, s = np.cos(aimed.angle), np.sin(aimed.angle)
            dx, dy = seen.x - grasp.x, seen.y - grasp.y
            aside = float(c * dx + s * dy), float(c * dy - s * dx)
            self.held = Held(thing, aside, aimed.z - TABLE)
        feedback("lifting")
        self._go(aimed.at(z=aimed.z + ABOVE), guard)
        self._retreat(guard)
        return f"the fingers are {1000 * self.machine.width:.0f} mm apart"

    def _place(self, args: tuple[str, ...], guard: Guard, feedback: Told) -> str:
        thing, where = args
        held = self.held
        if not self.closed_on_something or held is None or held.thing != thing:
            raise SkillError(f"{thing} is not in the hand")
        x, y, lowest = self._target(where)
        feedback(f"placing {thing}")
        for angle in (self._motions.grip.angle, np.pi / 2, 0.0, np.pi / 4, 3 * np.pi / 4):
            c, s = np.cos(angle), np.sin(angle)
            dx, dy = held.aside
            above = Grip(x - c * dx + s * dy, y - s * dx - c * dy, lowest + held.above, angle)
            try:
                self._motions.line(above.at(z=above.z + ABOVE), guard)
                self._motions.line(above, guard)
                break
            except OutOfReachError as error:
                reason = error
        else:
            raise SkillError(f"{where} is out of reach: {reason}")
        self._motions.fingers(guard, shut=False)
        self.shut, self.held = False, None
        self._go(above.at(z=above.z + ABOVE), guard)
        self._retreat(guard)
        return f"{thing} was let go over {where}"

    def _target(self, where: str) -> tuple[float, float, float]:
        """Where something is to be put: x, y, and the height that its underside shall have."""
        if where == "table":
            return 0.66, 0.0, TABLE + HIGH
        seen = self._see(where)
        if seen is None:
            raise SkillError(f"{where} is not in sight, or nothing can be put there")
        inside = where != "goal_area" and not where.startswith("toy")
        return seen.x, seen.y, (seen.top + INTO - 0.02) if inside else TABLE + HIGH

    def _reachable(self, shot: Shot, seen: Seen, guard: Guard) -> Grasp:
        valid = np.isfinite(shot.points[..., 2])
        grasps = self._grasps(
            shot.points[valid], seen.mask[valid], centre=(seen.x, seen.y), table=TABLE
        )
        if not grasps:
            raise SkillError("no grasp is seen")
        for grasp in islice(_unlike(grasps), TRIES):
            try:
                start = self._kinematics.line(
                    _grip(grasp).at(z=grasp.z + ABOVE), self.machine.reference
                )
                self._kinematics.line(_grip(grasp), start[-1])
            except OutOfReachError as error:
                reason = error
            else:
                return grasp
        raise SkillError(f"out of reach: {reason}")

    def _go(self, wanted: Grip, guard: Guard) -> None:
        try:
            self._motions.line(wanted, guard)
        except OutOfReachError as error:
            raise SkillError(f"out of reach: {error}") from error

    def _retreat(self, guard: Guard) -> None:
        """Straight up, then to where the arm carries; the fingers open where they hold nothing."""
        here = self._motions.grip
        angle = here.angle % (2 * np.pi) if self.held else CARRY.angle
        try:
            if np.hypot(here.x - CARRY.x, here.y - CARRY.y) > 0.02:
                self._motions.line(here.at(z=max(here.z, CARRY.z)), guard)
            self._motions.line(CARRY.at(angle=angle), guard)
        except OutOfReachError:
            self._go_back(guard)
        if self.shut and not self.closed_on_something:
            self._motions.fingers(guard, shut=False)
            self.shut, self.held = False, None

    def _go_back(self, guard: Guard) -> None:
        """To where the arm carries, all joints evenly, where that touches nothing."""
        there = self._kinematics.solve(CARRY, START)
        try:
            arms = self._kinematics.joint_by_joint(self.machine.reference, there)
        except OutOfReachError as error:
            raise SkillError(f"the arm cannot go back: {error}") from error
        self._motions.follow(arms, guard)


def _unlike(grasps: Sequence[Grasp]) -> Iterator[Grasp]:
    """The best grasp, then the best that is unlike all before it: what is near one that cannot be
    reached can hardly be reached either."""
    before: list[Grasp] = []
    for grasp in grasps:
        if not any(
            np.hypot(grasp.x - b.x, grasp.y - b.y) < UNLIKE[0]
            and abs(np.sin(grasp.angle - b.angle)) < np.sin(UNLIKE[1])
            for b in before
        ):
            before.append(grasp)
            yield grasp


def _grip(grasp: Grasp) -> Grip:
    return Grip(grasp.x, grasp.y, grasp.z, grasp.angle)


def _jpeg(rgb: Any) -> bytes:
    from PIL import Image

    out = BytesIO()
    Image.fromarray(rgb).save(out, "jpeg", quality=QUALITY)
    return out.getvalue()
