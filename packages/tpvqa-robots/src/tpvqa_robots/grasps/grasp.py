"""A grasp from above, whoever found it."""

from dataclasses import dataclass

DEEP, LOWEST = 0.024, 0.022
"""How far below the top the fingers close, and the least height above the table, metres."""


@dataclass(frozen=True, slots=True)
class Grasp:
    """Where the fingers close.

    Attributes:
        x: Metres ahead of the arm's foot.
        y: Metres to its left.
        z: Metres above the floor.
        angle: Of the direction in which they close, radians from x.
        width: Of what is between them, metres.
        quality: From 0 to 1; the best is tried first.
    """

    x: float
    y: float
    z: float
    angle: float
    width: float
    quality: float
