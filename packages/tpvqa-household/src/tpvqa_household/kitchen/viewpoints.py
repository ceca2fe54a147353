"""What the robot looks at in a state, from where, and what must stay out of the picture."""

import math
from collections.abc import Mapping

import numpy as np

from tpvqa_household.kitchen.cameras import Approach, Ball, Wanted, front_of
from tpvqa_household.kitchen.furniture import Furniture, hinge_side
from tpvqa_household.kitchen.household import HOMES, ITEMS, Household
from tpvqa_household.kitchen.rotation import Array
from tpvqa_household.kitchen.spots import Pose, Spots, radius


def ball(pose: Pose, furniture: Furniture, item: str) -> Ball:
    """A ball around an item that lies somewhere."""
    model = furniture.models[item]
    return pose.position + pose.axes @ [0, 0, model.extent[2] / 2], radius(model)


def fixture_balls(furniture: Furniture, fixture: str, *, opened: bool) -> list[Ball]:
    """Balls that cover the TV, the sink or the fridge."""
    models, layout = furniture.models, furniture.layout
    balls: list[Ball] = []
    if fixture == "tv":
        width, _, height = models["tv"].extent
        base = models["tvstand"].extent[2]
        middle = base + height / 2
        balls += [
            (layout.tv_stand.point(x * width, 0, middle), height * 0.55) for x in (-0.3, 0.0, 0.3)
        ]
    elif fixture == "sink":
        basin = models["sink"].surface("basin")
        at = layout.sink.point(basin.pos[0], basin.pos[1], models["counter"].extent[2])
        balls.append((at, max(basin.half) + 0.06))
        balls.append((at + np.array([0, 0, 0.15]), 0.15))
    elif fixture == "fridge":
        width, depth, height = models["fridge"].extent
        wide = math.hypot(width, depth) / 2
        balls += [(layout.fridge.point(0, 0, z), wide) for z in np.arange(0.25, height, 0.35)]
        if opened:
            side = hinge_side(furniture.models["fridge"]) * width / 2
            front = -depth / 2 - 0.3
            balls += [(layout.fridge.point(side, front, z), 0.35) for z in (0.6, 1.1, 1.5)]
    return balls


def approach(
    household: Household,
    spots: Spots,
    poses: Mapping[str, Pose],
    rng: np.random.Generator,
    *,
    door: float = 0.0,
) -> tuple[Approach, Wanted]:
    """How the robot looks at what it stands before.

    Args:
        household: The true state.
        spots: The kitchen's places.
        poses: Where the items lie.
        rng: Varies the point looked at.
        door: How far the fridge's door is open, radians.
    """
    furniture = spots.furniture
    subject = household.subject
    exempt = (
        set(household.hand_of).union(*map(household.upon, household.hand_of))
        | set(household.upon(household.near))
        | {household.near}
    )
    inside: list[Ball] = []
    seen = {subject}
    if subject in ITEMS:
        support = household.support(subject)
        place = household.where.get(subject)
        exempt |= set(household.upon(subject))
        while place in ITEMS:
            exempt |= {place, *household.upon(place)}
            place = household.where.get(place)
        if support == "sink":
            exempt |= set(household.upon("sink"))
        if support is None:  # it lies on something that a hand holds
            subject = household.where[subject]
            while subject in household.where:
                subject = household.where[subject]
            found = _fixture(household, spots, poses, HOMES[subject], rng, door)
            seen.add(HOMES[subject])
        elif support == "fridge" and not household.opened:
            found = _fixture(household, spots, poses, "fridge", rng, door)
            seen.add("fridge")
        else:
            item_ball = ball(poses[subject], furniture, subject)
            inside.append(item_ball)
            found = _item(spots, support, poses[subject], item_ball)
            seen.add(support)
    else:
        found = _fixture(household, spots, poses, subject, rng, door)
        if household.near == subject and subject in ("table", "counter", "floor"):
            inside += [ball(poses[x], furniture, x) for x in household.upon(subject)]
        if subject == "fridge":
            exempt -= set(household.upon("fridge"))
    outside = [
        ball(pose, furniture, item)
        for item, pose in poses.items()
        if item not in exempt
        and not (household.support(item) == "fridge" and not household.opened)
        and not ("fridge" in seen and household.support(item) == "fridge")
    ]
    for fixture in ("tv", "sink", "fridge"):
        if fixture not in seen:
            outside += fixture_balls(furniture, fixture, opened=household.opened)
    return found, Wanted(tuple(inside), tuple(outside))


def _item(spots: Spots, support: str, pose: Pose, item_ball: Ball) -> Approach:
    layout = spots.furniture.layout
    target = item_ball[0]
    if support == "floor":
        return Approach(target, 0.0, math.pi, (0.5, 0.85), (0.7, 1.0), (0.2, -0.1, 0.2))
    if support == "table":
        return Approach(target, 0.0, math.pi, (0.35, 0.6), (1.15, 1.35))
    if support == "counter":
        return Approach(target, front_of(layout.counter.stand), 0.6, (0.4, 0.6), (1.3, 1.5))
    if support == "sink":
        return Approach(target, front_of(layout.sink), 0.5, (0.35, 0.55), (1.25, 1.5))
    hinge = hinge_side(spots.furniture.models["fridge"])
    return Approach(
        target,
        front_of(layout.fridge) - hinge * 0.25,
        0.35,
        (0.7, 0.95),
        (target[2] + 0.15, target[2] + 0.4),
        (0.15, 0.0, 0.3),
    )


def _fixture(
    household: Household,
    spots: Spots,
    poses: Mapping[str, Pose],
    fixture: str,
    rng: np.random.Generator,
    door: float,
) -> Approach:
    furniture, layout = spots.furniture, spots.furniture.layout
    if fixture == "tv":
        _, _, height = furniture.models["tv"].extent
        base = furniture.models["tvstand"].extent[2]
        target = layout.tv_stand.point(0, 0, base + height / 2)
        return Approach(target, front_of(layout.tv_stand), 0.45, (1.1, 1.7), (1.15, 1.5))
    if fixture == "sink":
        basin = furniture.models["sink"].surface("basin")
        target = layout.sink.point(
            basin.pos[0], basin.pos[1], furniture.models["sink"].surface("basin").pos[2] + 0.12
        )
        return Approach(target, front_of(layout.sink), 0.4, (0.45, 0.75), (1.4, 1.65))
    if fixture == "fridge":
        return _fridge(household, furniture, rng, door)
    lying = [poses[x].position for x in household.upon(fixture)]
    areas = spots.areas[fixture]
    if household.near == fixture and lying:
        target = np.mean(lying, axis=0)
        spread = max(float(np.linalg.norm(at - target)) for at in lying)
    else:
        area = areas[int(rng.integers(len(areas)))]
        x, y = area.half
        target = area.stand.point(rng.uniform(-x, x), rng.uniform(-y, y))
        spread = 0.0
    back = 1.6 * spread
    if fixture == "floor":
        return Approach(
            target,
            0.0,
            math.pi,
            (0.6 + back, 1.0 + back),
            (0.8 + back / 2, 1.2 + back / 2),
            (0.2, -0.15, 0.2),
        )
    if fixture == "table":
        return Approach(target, 0.0, math.pi, (0.4 + back, 0.7 + back), (1.2, 1.45))
    front = front_of(layout.counter.stand)
    return Approach(target, front, 0.6, (0.45 + back, 0.75 + back), (1.3, 1.5))


def _fridge(
    household: Household, furniture: Furniture, rng: np.random.Generator, door: float
) -> Approach:
    layout = furniture.layout
    _, depth, height = furniture.models["fridge"].extent
    target: Array = layout.fridge.point(0, -depth / 2, float(rng.uniform(0.62, 0.72)) * height)
    front = front_of(layout.fridge)
    if household.opened:
        # From a little beyond the door's own plane it hides one half of the inside, not the other.
        beside = hinge_side(furniture.models["fridge"]) * (door - math.pi / 2 + 0.36)
        return Approach(target, front + beside, 0.2, (1.15, 1.6), (1.3, 1.6), (0.15, -0.1, 0.2))
    return Approach(target, front, 0.6, (0.9, 1.4), (1.25, 1.55), (0.2, -0.1, 0.25))
