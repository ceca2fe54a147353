"""The ways of finding grasps, by name."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tpvqa.errors import PluginError
from tpvqa_robots.grasps.antipodal import antipodal
from tpvqa_robots.grasps.ggcnn import ggcnn
from tpvqa_robots.grasps.grasp import Grasp

WORD = "grasps="


class Method(Protocol):
    """Finds grasps of a thing, the best first; see `antipodal.antipodal`."""

    def __call__(
        self,
        points: NDArray[np.float64],
        thing: NDArray[np.bool_],
        *,
        centre: tuple[float, float],
        table: float,
    ) -> list[Grasp]: ...


METHODS: Mapping[str, Method] = {"antipodal": antipodal, "ggcnn": ggcnn}


def said(words: str, world: str) -> tuple[Method, str]:
    """Take the word `grasps=…` out of a world's words.

    Args:
        words: As `slip=0.2:grasps=ggcnn`.
        world: The world that they are for; named in errors.

    Returns:
        The method, antipodal where none is named, and the other words.

    Raises:
        PluginError: There is no such method, or two are named.
    """
    parts = words.split(":") if words else []
    named = [part.removeprefix(WORD) for part in parts if part.startswith(WORD)]
    if len(named) > 1 or any(name not in METHODS for name in named):
        raise PluginError(
            f"The world {world!r} does not understand {WORD}{named[-1][:40]!r}: grasps are found "
            f"by one of {', '.join(METHODS)}. Write {world}:{WORD}ggcnn."
        )
    rest = ":".join(part for part in parts if not part.startswith(WORD))
    return METHODS[named[0] if named else "antipodal"], rest
