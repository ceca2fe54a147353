"""Score the embedded network: `python -m tpvqa_household.training.evaluate --help`.

By default on the pictures that come with the package. Needs no torch.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from tpvqa.errors import TpvqaError
from tpvqa_household.embedded import EmbeddedVLM
from tpvqa_household.images.manifest import load_pictures
from tpvqa_household.training.asking import Asking
from tpvqa_household.training.cases import photographs, rendered
from tpvqa_household.training.picture_cases import picture_cases
from tpvqa_household.training.recipe import Recipe
from tpvqa_household.training.scoring import as_json, no_household_answers, report, score


def main(arguments: Sequence[str] | None = None) -> int:
    """Score the embedded network."""
    parser = argparse.ArgumentParser(
        prog="python -m tpvqa_household.training.evaluate",
        description=(__doc__ or "").splitlines()[0],
    )
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--pictures", type=Path, help="a picture set instead of the shipped one")
    which.add_argument(
        "--rendered", type=Path, help="a folder that `render` filled; parts kept from training"
    )
    which.add_argument(
        "--photographs", type=Path, help="a folder of pictures that show no household"
    )
    parser.add_argument("--weights", type=Path, default=None, help="instead of the shipped ones")
    parser.add_argument("--every-wording", action="store_true")
    parser.add_argument("--json", action="store_true")
    chosen = parser.parse_args(arguments)
    try:
        recipe = Recipe.read()
        asking = Asking.about(recipe.task)
        vlm = EmbeddedVLM(folder=chosen.weights)
        if chosen.photographs is not None:
            print(no_household_answers(vlm, photographs(chosen.photographs), asking))
            return 0
        kept = range(recipe.validation_from, 1_000_000)
        cases = (
            picture_cases(load_pictures(chosen.pictures))
            if chosen.rendered is None
            else rendered(chosen.rendered, kept)
        )
        rows = list(score(vlm, cases, asking, every_wording=chosen.every_wording))
    except TpvqaError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(json.dumps(as_json(rows, asking)) if chosen.json else report(rows, asking))
    return 0


if __name__ == "__main__":
    sys.exit(main())
