"""The rival: the most probable arrangement, answers taken to be independent.

Its rates of yes are by VLM, predicate and truth; every arrangement is as likely as another.
"""

from collections.abc import Sequence

import numpy as np

from tpvqa_experiments.scenes.arrangements import arrangements
from tpvqa_experiments.scenes.likelihood import weights_of
from tpvqa_experiments.scenes.recorded import Scene
from tpvqa_experiments.scenes.ridge import Array
from tpvqa_experiments.scenes.situations import holds, looks

Rates = dict[tuple[str, str, bool], float]
"""P(yes) by VLM, predicate, and whether yes is right."""


def learn_rates(scenes: Sequence[Scene]) -> Rates:
    """The rates of yes of each VLM over scenes before the first action."""
    first = [scene for scene in scenes if scene.look == 0]
    yes: dict[tuple[str, str, bool], float] = {}
    asked: dict[tuple[str, str, bool], float] = {}
    for scene, count in zip(first, weights_of(first), strict=True):
        for look, answer in zip(looks(scene.shape), scene.answers, strict=True):
            if answer >= 0:
                true = holds(look.predicate, look.situations[look.of[scene.truth]])
                key = scene.model, look.predicate, true
                yes[key] = yes.get(key, 0.0) + count * float(answer)
                asked[key] = asked.get(key, 0.0) + count
    return {key: (yes[key] + 0.5) / (asked[key] + 1.0) for key in asked}


def naive_log_belief(scene: Scene, rates: Rates) -> Array:
    """The logarithm of the probability of every arrangement."""
    found = np.zeros(len(arrangements(scene.shape).column))
    for look, answer in zip(looks(scene.shape), scene.answers, strict=True):
        if answer >= 0:
            p = np.array(
                [
                    rates.get((scene.model, look.predicate, holds(look.predicate, seen)), 0.5)
                    for seen in look.situations
                ]
            )
            found += np.log(p if answer else 1 - p)[look.of]
    return np.asarray(found - np.logaddexp.reduce(found))
