"""Where things lie: positions on the surfaces that a state names."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from tpvqa.chance import chance_array
from tpvqa_household.kitchen.assets import Model
from tpvqa_household.kitchen.falling import come_to_rest
from tpvqa_household.kitchen.furniture import Furniture, hinge_side
from tpvqa_household.kitchen.household import Household
from tpvqa_household.kitchen.layout import Area, Stand
from tpvqa_household.kitchen.rotation import Array, about_y, about_z


@dataclass(frozen=True, slots=True)
class Pose:
    """Position and axes (as columns) of a body."""

    position: Array
    axes: Array


def radius(model: Model) -> float:
    """Of a ball around the thing that is centred half-way up."""
    x, y, z = model.extent
    return math.sqrt(x * x + y * y + z * z) / 2


class Spots:
    """Draws places in one kitchen.

    Args:
        furniture: What stands where.
        seed: Of the kitchen.
    """

    def __init__(self, furniture: Furniture, seed: int):
        self.furniture, self.seed = furniture, seed
        layout, models = furniture.layout, furniture.models
        table = models["table"].surface("top")
        x, y, z = table.pos
        at = layout.table.point(x, y, z)
        self.areas: dict[str, list[Area]] = {
            "counter": [layout.counter],
            "table": [
                Area(
                    "table",
                    Stand(at[0], at[1], layout.table.yaw, at[2]),
                    (table.half[0] - 0.12, table.half[1] - 0.12),
                )
            ],
            "floor": list(layout.floors),
            "sink": [self._inside("sink", "basin", 0.7)],
            "fridge": [
                self._inside("fridge", surface.name, 0.8, hinge_side(models["fridge"]))
                for surface in models["fridge"].surfaces
                if surface.name.startswith("shelf") and 0.45 < surface.pos[2] < 1.35
            ],
        }
        x, y, z = models["tvstand"].surface("top").pos
        top = layout.tv_stand.point(x, y, z)
        self._stand_top = Area(
            "tv", Stand(top[0], top[1], layout.tv_stand.yaw, top[2]), (0.55, 0.1)
        )

    def _inside(self, fixture: str, surface_name: str, around: float, side: float = 0.0) -> Area:
        """A surface of a fixture; its half towards one side where the other is to stay free."""
        surface = self.furniture.models[fixture].surface(surface_name)
        stand: Stand = getattr(self.furniture.layout, fixture)
        half = (max(surface.half[0] - 0.1, 0.03), max(surface.half[1] - 0.1, 0.03))
        if side:
            half = (half[0] / 2, half[1])
        x, y, z = surface.pos
        at = stand.point(x + side * half[0], y, z)
        return Area(fixture, Stand(at[0], at[1], stand.yaw, at[2]), half, around)

    def place(
        self,
        household: Household,
        key: tuple[object, ...],
        *,
        together: str | None = None,
        fixed: Mapping[str, Pose] | None = None,
    ) -> dict[str, Pose]:
        """A pose for every item that lies on a fixture, directly or through another item.

        The draw of an item depends on the key, the item and where it lies, so an item stays
        where it is while others move, unless it would have to share its place. The items
        on the fixture `together` are put side by side; `fixed` ones are where they are.
        """
        models = self.furniture.models
        taken = [(pose.position, radius(models[name])) for name, pose in self.loose(key).items()]
        poses: dict[str, Pose] = dict(fixed or {})
        taken += [(pose.position, radius(models[item])) for item, pose in poses.items()]
        for item, place in household.where.items():
            if place not in self.areas or item in poses:
                continue
            rng = chance_array(self.seed, 0, "spot", item, place, *key)
            others = [poses[x].position for x in poses if household.where.get(x) == place]
            by = np.mean(others, axis=0) if others and place == together else None
            poses[item] = self._free(self.areas[place], models[item], rng, taken, by=by)
            if place == "floor":
                poses[item] = self.dropped(item, poses[item].position, rng)
            taken.append((poses[item].position, radius(models[item])))
        return poses | self.upon(household, poses, key)

    def dropped(self, item: str, at: Array, rng: np.random.Generator) -> Pose:
        """How an item lies after it fell to the floor at a point."""
        position, axes = come_to_rest(self.furniture.models[item], rng)
        return Pose(np.array([at[0], at[1], 0.0]) + position, axes)

    def floor_beside(self, at: Array, away: float, rng: np.random.Generator) -> Array:
        """The middle of a free patch of floor about so far away from a point."""
        centres = np.array([area.stand.point(0, 0) for area in self.areas["floor"]])
        distance = np.linalg.norm(centres[:, :2] - np.asarray(at)[:2], axis=1)
        nearest = np.argsort(abs(distance - away))[:4]
        return np.asarray(centres[int(rng.choice(nearest))])

    def upon(
        self, household: Household, poses: Mapping[str, Pose], key: tuple[object, ...]
    ) -> dict[str, Pose]:
        """Poses of the items that lie on other items whose pose is known."""
        found: dict[str, Pose] = {}
        below = dict(poses)
        waiting = [(x, p) for x, p in household.where.items() if x not in poses]
        while ready := [(x, p) for x, p in waiting if p in below]:
            for turn, (item, place) in enumerate(ready):
                rng = chance_array(self.seed, 0, "spot", item, place, *key)
                base = below[place]
                middle = self.furniture.models[place].surface("middle")
                angle = 2.4 * turn + rng.uniform(0, 2 * math.pi)
                reach = 0.012 if len(ready) == 1 else 0.05
                offset = np.array([math.cos(angle) * reach, math.sin(angle) * reach, 0.0])
                spin = about_z(rng.uniform(0, 2 * math.pi))
                found[item] = below[item] = Pose(
                    base.position + base.axes @ (np.asarray(middle.pos) + offset + [0, 0, 0.004]),
                    base.axes @ spin,
                )
            waiting = [(x, p) for x, p in waiting if x not in found]
        return found

    def loose(self, key: tuple[object, ...]) -> dict[str, Pose]:
        """Poses of the distractors: on counter, table and TV stand."""
        found: dict[str, Pose] = {}
        models = self.furniture.models
        taken: list[tuple[Array, float]] = []
        for name in self.furniture.loose:
            rng = chance_array(self.seed, 0, "loose", name, *key)
            choice = [self.areas["counter"], self.areas["table"], [self._stand_top]]
            areas = choice[int(rng.choice(3, p=[0.5, 0.4, 0.1]))]
            if rng.random() < 0.15:
                continue
            found[name] = self._free(areas, models[name], rng, taken, yaw=1.0)
            taken.append((found[name].position, radius(models[name])))
        return found

    def _free(
        self,
        areas: list[Area],
        model: Model,
        rng: np.random.Generator,
        taken: list[tuple[Array, float]],
        *,
        yaw: float = math.pi,
        by: Array | None = None,
    ) -> Pose:
        """A pose that shares its place with nothing, if one is found soon."""
        best, most = None, -math.inf
        for area, at in self._candidates(areas, rng):
            room = min(
                (
                    float(np.linalg.norm(at - other)) - r - radius(model)
                    for other, r in taken
                    if abs(at[2] - other[2]) < 0.3
                ),
                default=1.0,
            )
            if by is not None:  # near the others, as far as there is room
                room = min(room, 0.02) - 0.1 * max(float(np.linalg.norm(at - by)) - 0.3, 0.0)
            if room > most:
                turn = area.stand.yaw + rng.uniform(-yaw, yaw)
                best, most = Pose(at, about_z(turn)), room
            if room >= 0.02:
                break
        if best is None:
            raise ValueError(f"there is nowhere to put {model.name}")
        return best

    def _candidates(
        self, areas: list[Area], rng: np.random.Generator
    ) -> Iterator[tuple[Area, Array]]:
        for _ in range(40):
            area = areas[int(rng.integers(len(areas)))]
            x, y = area.half
            yield area, area.stand.point(rng.uniform(-x, x), rng.uniform(-y, y))


def halves(
    pose: Pose, whole: Model, rng: np.random.Generator, *, robot: Array, held: bool
) -> tuple[Pose, Pose]:
    """The two halves of a cut apple around the place of the whole one, faces in view.

    Args:
        pose: Of the whole apple.
        whole: The apple.
        rng: Varies how they lie.
        robot: Where it is seen from; the halves lean that way.
        held: In a hand, where both keep the apple's own direction.
    """
    half = whole.half or whole
    height = half.extent[2]
    if held:
        apart = pose.axes @ np.array([0.0, 0.5 * whole.extent[0], 0.0])
        turns = [pose.axes @ about_z(rng.uniform(0, 6)) for _ in range(2)]
        return Pose(pose.position - apart, turns[0]), Pose(pose.position + apart, turns[1])
    middle = pose.position + pose.axes @ np.array([0, 0, whole.extent[2] / 2])
    ground = middle - [0, 0, whole.extent[2] / 2]
    away = robot - middle
    facing = math.atan2(away[1], away[0])
    steep = math.atan2(math.hypot(away[0], away[1]), max(float(away[2]), 0.05))
    side = facing + math.pi / 2 + rng.uniform(-0.6, 0.6)
    apart = (
        np.array([math.cos(side), math.sin(side), 0.0]) * whole.extent[0] * rng.uniform(0.55, 0.8)
    )
    found = []
    for sign, lean in ((-1, rng.uniform(0.1, 0.5)), (1, rng.uniform(0.4, 0.8))):
        # It rolls on its round back, about the middle of its face, towards the robot.
        turn = about_z(facing + rng.uniform(-0.5, 0.5)) @ about_y(lean * steep)
        axes = turn @ about_z(rng.uniform(0, 6))
        up = np.array([0, 0, height])
        found.append(Pose(ground + sign * apart + up - axes @ up, axes))
    return found[0], found[1]
