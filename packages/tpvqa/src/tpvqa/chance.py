"""Random numbers as functions of what they are for.

Every draw is a function of (seed, episode, purpose, key), never of a shared stream: the same
faults meet every monitor, the number of workers does not matter, and a resumed trial is the
unbroken one.
"""

import hashlib
import random
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np


def _digest(seed: int, episode: int, purpose: str, key: tuple[object, ...]) -> int:
    text = "\x1f".join([str(seed), str(episode), purpose, *map(str, key)])
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=16).digest(), "little")


def chance(seed: int, episode: int, purpose: str, *key: object) -> random.Random:
    """A generator that depends on nothing but its arguments.

    Args:
        seed: The user's seed.
        episode: Number of the episode under this seed.
        purpose: What is drawn, e.g. "fault", "picture", "answer".
        key: What tells this draw from others of its purpose; compared by `str`.
    """
    return random.Random(_digest(seed, episode, purpose, key))


def chance_array(seed: int, episode: int, purpose: str, *key: object) -> "np.random.Generator":
    """The same as `chance`, as a NumPy generator."""
    import numpy as np

    return np.random.default_rng(_digest(seed, episode, purpose, key))
