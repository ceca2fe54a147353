"""Knives in many shapes; held out: cleavers and knives made of one piece of steel."""

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.knife import (
    HANDLES,
    STEEL,
    Blade,
    any_steel,
    build_knife,
    grip_colour,
)
from tpvqa_household.kitchen.assets.model import Model
from tpvqa_household.kitchen.assets.paint import near, one_of


def chef(rng: Generator) -> Model:
    """A wide kitchen knife whose edge curves up to the tip."""
    t = np.linspace(0, 1, 16)
    wide, length = rng.uniform(0.034, 0.05), rng.uniform(0.16, 0.23)
    belly = rng.uniform(2.2, 3.5)
    edge = -wide * 0.72 * (1 - t**belly)
    back = wide * 0.28 * (1 - t**4)
    back[-1] = edge[-1] + 0.001
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.0028),
        rng.uniform(0.11, 0.135),
        0.018,
        colour=grip_colour(rng),
        rivets=int(rng.choice([0, 2, 3])),
        bolster=rng.random() < 0.5,
    )


def paring(rng: Generator) -> Model:
    """A small knife with a narrow blade."""
    t = np.linspace(0, 1, 14)
    wide, length = rng.uniform(0.018, 0.025), rng.uniform(0.085, 0.12)
    edge = -wide * 0.6 * (1 - t**3)
    back = wide * 0.4 * (1 - t ** rng.uniform(2, 5))
    back[-1] = edge[-1] + 0.0008
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.002),
        rng.uniform(0.095, 0.115),
        0.016,
        colour=grip_colour(rng),
        rivets=int(rng.choice([0, 2])),
        bend=rng.uniform(0, 0.004),
    )


def santoku(rng: Generator) -> Model:
    """A wide blade with a straight edge and a back that drops to the tip."""
    t = np.linspace(0, 1, 18)
    wide, length = rng.uniform(0.042, 0.052), rng.uniform(0.15, 0.185)
    edge = -wide * 0.75 * (1 - 0.12 * t**4)
    back = wide * 0.25 - wide * 0.88 * np.clip((t - 0.72) / 0.28, 0, 1) ** 2.2
    back[-1] = edge[-1] + 0.001
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.0024),
        rng.uniform(0.115, 0.135),
        0.019,
        colour=grip_colour(rng),
        rivets=int(rng.choice([0, 3])),
        bolster=rng.random() < 0.6,
    )


def bread_knife(rng: Generator) -> Model:
    """A long narrow blade with a saw edge."""
    t = np.linspace(0, 1, 44)
    wide, length = rng.uniform(0.026, 0.034), rng.uniform(0.19, 0.24)
    edge = -wide * 0.6 + 0 * t
    back = wide * 0.4 - wide * 0.75 * np.clip((t - 0.9) / 0.1, 0, 1) ** 2
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.0022),
        rng.uniform(0.11, 0.13),
        0.018,
        colour=grip_colour(rng),
        rivets=int(rng.choice([0, 3])),
        serrated=True,
    )


def table_knife(rng: Generator) -> Model:
    """A dinner knife: slim, round tip, handle of steel or of plastic."""
    t = np.linspace(0, 1, 16)
    wide, length = rng.uniform(0.018, 0.023), rng.uniform(0.1, 0.125)
    tip = np.sqrt(np.clip(1 - np.clip((t - 0.86) / 0.14, 0, 1) ** 2, 0, 1))
    edge = -wide * (0.45 + 0.12 * np.sin(np.pi * t)) * tip
    back = wide * 0.45 * tip
    colour = near(rng, STEEL, 0.03) if rng.random() < 0.5 else one_of(rng, HANDLES)
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.0022),
        rng.uniform(0.095, 0.11),
        0.011,
        colour=colour,
        wide=1.6,
    )


def utility(rng: Generator) -> Model:
    """A medium blade, its back straight, its edge rising evenly to a point."""
    t = np.linspace(0, 1, 16)
    wide, length = rng.uniform(0.024, 0.034), rng.uniform(0.12, 0.165)
    edge = -wide * 0.7 * (1 - t ** rng.uniform(1.4, 2.2))
    back = wide * 0.3 * (1 - 0.9 * t**6)
    back[-1] = edge[-1] + 0.0008
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.0022),
        rng.uniform(0.1, 0.125),
        0.016,
        colour=grip_colour(rng),
        rivets=int(rng.choice([0, 2, 3])),
        look=any_steel(rng),
        butt=grip_colour(rng) if rng.random() < 0.35 else None,
    )


def steak(rng: Generator) -> Model:
    """A slender pointed blade whose back falls to the tip, often with a saw edge."""
    t = np.linspace(0, 1, 30)
    wide, length = rng.uniform(0.016, 0.022), rng.uniform(0.1, 0.135)
    edge = -wide * 0.5 * (1 - t**8)
    back = wide * 0.5 - wide * np.clip((t - 0.55) / 0.45, 0, 1) ** 1.6
    back[-1] = edge[-1] - wide * 0.5 + 0.001
    edge[-1] = back[-1] - 0.0008
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.002),
        rng.uniform(0.1, 0.12),
        rng.uniform(0.012, 0.016),
        colour=grip_colour(rng),
        rivets=int(rng.choice([0, 2, 3])),
        serrated=rng.random() < 0.5,
        bolster=rng.random() < 0.3,
        look=any_steel(rng),
    )


def butter(rng: Generator) -> Model:
    """A short blunt blade that widens to a round end, on a handle that widens to its end."""
    t = np.linspace(0, 1, 20)
    wide, length = rng.uniform(0.02, 0.03), rng.uniform(0.075, 0.11)
    swell = 0.55 + 0.45 * np.sin(np.pi / 2 * np.clip(t / 0.6, 0, 1)) ** 2
    tip = np.sqrt(np.clip(1 - np.clip((t - 0.72) / 0.28, 0, 1) ** 2, 0, 1))
    look = any_steel(rng)
    return build_knife(
        rng,
        Blade(length, t, -wide * 0.6 * swell * tip, wide * 0.4 * swell * tip, 0.002),
        rng.uniform(0.09, 0.11),
        rng.uniform(0.007, 0.011),
        colour=look.colour if rng.random() < 0.6 else grip_colour(rng),
        wide=rng.uniform(1.6, 2.2),
        look=look,
        swell=np.linspace(rng.uniform(0.5, 0.7), 1.0, 12),
    )


def boning(rng: Generator) -> Model:
    """A narrow blade that curves up, on a straight handle with a guard for the finger."""
    t = np.linspace(0, 1, 18)
    wide, length = rng.uniform(0.015, 0.021), rng.uniform(0.13, 0.17)
    sweep = rng.uniform(0.004, 0.02) * t**3
    edge = -wide * 0.5 * (1 - t**4) + sweep
    back = wide * 0.5 * (1 - t**6) + sweep
    back[-1] = edge[-1] + 0.0008
    guard = np.r_[1.35, 0.8, np.linspace(0.9, 1.1, 9), 0.95]
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.002),
        rng.uniform(0.115, 0.135),
        rng.uniform(0.016, 0.02),
        colour=grip_colour(rng),
        look=any_steel(rng),
        swell=guard,
    )


def carving(rng: Generator) -> Model:
    """A long blade of even width, its end pointed or round, on a grip often of two colours."""
    t = np.linspace(0, 1, 20)
    wide, length = rng.uniform(0.022, 0.032), rng.uniform(0.2, 0.25)
    end = np.clip((t - 0.88) / 0.12, 0, 1)
    if rng.random() < 0.5:
        tip = np.sqrt(np.clip(1 - end**2, 0, 1))
        edge, back = -wide * 0.55 * tip, wide * 0.45 * tip
    else:
        edge, back = -wide * 0.55 * (1 - end**1.5), wide * 0.45 - wide * 0.44 * end**2
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.0022),
        rng.uniform(0.115, 0.14),
        rng.uniform(0.016, 0.02),
        colour=grip_colour(rng),
        rivets=int(rng.choice([0, 3])),
        bolster=rng.random() < 0.5,
        look=any_steel(rng),
        butt=grip_colour(rng) if rng.random() < 0.5 else None,
    )


def butcher(rng: Generator) -> Model:
    """A tall blade, widest before its round, clipped end, on a handle that may curve down."""
    t = np.linspace(0, 1, 22)
    wide, length = rng.uniform(0.046, 0.066), rng.uniform(0.15, 0.21)
    grow = 0.72 + 0.28 * np.sin(np.pi / 2 * np.clip(t / 0.7, 0, 1))
    round_end = np.clip((t - 0.62) / 0.38, 0, 1)
    edge = -wide * 0.75 * grow * (1 - round_end**2.4)
    back = wide * 0.25 * (1 - 0.4 * t) - wide * 0.22 * round_end**1.5
    back[-1] = edge[-1] + 0.001
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.003),
        rng.uniform(0.115, 0.14),
        rng.uniform(0.018, 0.022),
        colour=grip_colour(rng),
        rivets=int(rng.choice([0, 3])),
        bend=rng.uniform(-0.008, 0.0),
        look=any_steel(rng),
    )


def hollow_handled(rng: Generator) -> Model:
    """Blade and waisted, hollow handle of the same steel; the handle straight or curving down."""
    t = np.linspace(0, 1, 16)
    wide, length = rng.uniform(0.022, 0.042), rng.uniform(0.11, 0.2)
    edge = -wide * 0.68 * (1 - t ** rng.uniform(2, 4))
    back = wide * 0.32 * (1 - t ** rng.uniform(3, 8))
    back[-1] = edge[-1] + 0.0008
    look = any_steel(rng)
    along = np.linspace(0, 1, 12)
    swell = 0.72 + 0.3 * np.sin(np.pi * along) ** 2 + rng.uniform(0, 0.25) * along**2
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.0024),
        rng.uniform(0.1, 0.13),
        rng.uniform(0.013, 0.019),
        colour=near(rng, look.colour, 0.04),
        bend=rng.uniform(-0.01, 0.003),
        wide=rng.uniform(1.1, 1.6),
        look=look,
        butt=near(rng, (0.1, 0.1, 0.11)) if rng.random() < 0.3 else None,
        swell=swell,
    )


def cleaver(rng: Generator) -> Model:
    """Held out: a rectangular blade."""
    t = np.linspace(0, 1, 6)
    wide, length = rng.uniform(0.065, 0.085), rng.uniform(0.15, 0.185)
    edge = -wide * 0.78 + 0 * t
    back = wide * (0.22 + 0.05 * t)
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.003),
        rng.uniform(0.11, 0.13),
        0.021,
        colour=near(rng, (0.42, 0.28, 0.16)),
        rivets=int(rng.choice([0, 2])),
    )


def steel_knife(rng: Generator) -> Model:
    """Held out: blade and curved handle of one piece of steel, or with a two-coloured grip."""
    t = np.linspace(0, 1, 18)
    wide, length = rng.uniform(0.024, 0.032), rng.uniform(0.14, 0.19)
    sweep = 0.012 * t**2.2
    edge = -wide * 0.62 * (1 - t**5) + sweep
    back = wide * 0.38 * (1 - t**2.5) + sweep
    back[-1] = edge[-1] + 0.0008
    colour = near(rng, STEEL, 0.03) if rng.random() < 0.5 else near(rng, (0.85, 0.45, 0.1))
    return build_knife(
        rng,
        Blade(length, t, edge, back, 0.0024),
        rng.uniform(0.12, 0.14),
        0.017,
        colour=colour,
        bend=0.009,
        wide=1.4,
        bolster=True,
    )
