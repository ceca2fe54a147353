"""Work out how far a VLM of which nothing is known can be trusted: `python tools/default_trust.py`.

Prints by what factor the words of each recorded VLM, in each environment, are worth more or less
than the default calibration takes them to be worth (log odds of being right, yes and no alike):
`RECORDED` in `tpvqa.belief.answers.trust`. From the shipped recordings of ViPlan (Merler et al.
2025).
"""

import gzip
import json
from collections import Counter
from importlib.resources import files
from math import log

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.vlm import Reply

ANSWERS = files("tpvqa.vlm.recorded") / "answers.json.gz"


def factors() -> dict[tuple[str, str], float]:
    """The factor of each model and environment."""
    counts: Counter[tuple[str, str, int, str]] = Counter()
    for row in json.loads(gzip.decompress(ANSWERS.read_bytes()))["rows"]:
        model, environment, _, _, truth, _, answer, _, times = row
        counts[model, environment, truth, answer] += times
    taken = Calibration.default().whole.log_ratio(Reply.YES, None)
    found = {}
    for model, environment in sorted({key[:2] for key in counts}):
        right = [
            counts[model, environment, truth, answer]
            / sum(counts[model, environment, truth, each] for each in ("yes", "no"))
            for truth, answer in ((1, "yes"), (0, "no"))
        ]
        balanced = sum(right) / 2
        found[model, environment] = log(balanced / (1 - balanced)) / taken
    return found


if __name__ == "__main__":
    for (model, environment), factor in factors().items():
        print(f"{model:20} {environment:12} {factor:.2f}")
    print("RECORDED =", tuple(sorted(round(factor, 2) for factor in factors().values())))
