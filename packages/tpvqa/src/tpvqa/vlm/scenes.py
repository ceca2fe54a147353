"""What tells scenes apart for noise models whose errors last: true state and views."""

from tpvqa.errors import PluginError
from tpvqa.observation import Observation
from tpvqa.vlm.protocol import TruthSource


def scene_of(observation: Observation, truth: TruthSource) -> str:
    """What is seen: the true state, and the views that there are pictures of.

    Two looks at the same scene give the same text, in every process and after a trial was gone on
    with.
    """
    return "/".join((truth.scene(), *sorted(observation.frames)))


def tells_scenes(truth: TruthSource, spec: str, instead: str) -> None:
    """See that a world tells its scenes apart, before errors are to last in them.

    Args:
        truth: What is true in the world, perhaps of a plug-in older than scenes.
        spec: The noise model that needs it.
        instead: One that does not.

    Raises:
        PluginError: It does not.
    """
    if not callable(getattr(truth, "scene", None)):
        kind = type(truth)
        raise PluginError(
            f"With {spec!r} errors last as long as the scene does, and the world's truth "
            f"({kind.__module__}.{kind.__qualname__}) has no scene() that tells scenes apart. "
            f"Give it one (see tpvqa.vlm.TruthSource), or choose {instead!r}."
        )
