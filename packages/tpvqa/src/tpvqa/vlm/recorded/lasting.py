"""How the recorded errors of real VLMs last, as `tools/lasting_errors.py` fitted it.

Fitted to whole scenes that the models were shown again and again (ViPlan, Merler et al. 2025).
"""

import json
from dataclasses import dataclass
from functools import cache
from importlib import resources

from tpvqa.errors import AnswerError


@dataclass(frozen=True, slots=True)
class Lasting:
    """Which share of a model's answers lasts, with intervals of 95%.

    An answer is with probability `scene` the scene's own draw for the question, and this is with
    probability `trial` one for the whole trial. So two answers about an unchanged fact correlate by
    scene² in the same scene, and by (scene trial)² in another.

    Attributes:
        scene: The share that belongs to scene and question.
        trial: The share of that which belongs to the question alone.
        scene_interval: Of `scene`.
        trial_interval: Of `trial`.
    """

    scene: float
    trial: float
    scene_interval: tuple[float, float]
    trial_interval: tuple[float, float]


@cache
def lasting(model: str, environment: str) -> Lasting:
    """What was fitted to a model in an environment; to all models, where none is named.

    Raises:
        AnswerError: The file of it cannot be read.
    """
    try:
        text = (resources.files(__package__) / "lasting.json").read_text(encoding="utf-8")
        told = json.loads(text)[environment][model]
        (scene, *scene_ends), (trial, *trial_ends) = told["scene"], told["trial"]
        return Lasting(scene, trial, (scene_ends[0], scene_ends[1]), (trial_ends[0], trial_ends[1]))
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise AnswerError(
            f"What lasts of the recorded errors cannot be read ({error}). Install tpvqa again."
        ) from error
