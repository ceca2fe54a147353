"""What came of ViPlan's published runs of its grounder."""

import csv
from dataclasses import dataclass
from pathlib import Path

from tpvqa.errors import BenchError, PlacedError
from tpvqa.text_files import read_text

FILE = "grounder.csv"
MODELS = {
    "Qwen2.5-VL-72B-Instruct": "qwen2.5-vl-72b",
    "Qwen2.5-VL-7B-Instruct": "qwen2.5-vl-7b",
    "InternVL3-8B": "internvl3-8b",
    "aya-vision-8b": "aya-vision-8b",
    "gemma-3-12b-it": "gemma-3-12b",
    "gpt-4.1-nano": "gpt-4.1-nano",
    "Phi-4-multimodal-instruct": "phi-4-multimodal",
    "llava-onevision-qwen2-7b-ov-hf": "llava-onevision-7b",
}
"""The models by the names that ViPlan has for them, as `recorded:MODEL` calls them."""


@dataclass(frozen=True, slots=True)
class Published:
    """What came of one model's episodes in one split.

    Attributes:
        episodes: How many there were.
        reached: In how many the goal was reached.
        ended: In how many there was no action to be checked.
        answers: Answers about preconditions and effects.
        right: How many of them were right.
    """

    episodes: int
    reached: int
    ended: int
    answers: int
    right: int


Key = tuple[str, str, str, str]
"""Environment, setting ("no_cot"; "fail01_no_cot" where actions fail), split, model."""


def published(folder: Path) -> dict[Key, Published]:
    """The rows of `grounder.csv`; none where there is no such file.

    Raises:
        BenchError: It is damaged.
    """
    path = folder / FILE
    if not path.exists():
        return {}
    try:
        lines = read_text(path, PlacedError, what="table").splitlines()
    except PlacedError as error:
        raise BenchError(str(error)) from error
    found = {}
    for number, row in enumerate(csv.DictReader(lines), 2):
        try:
            key = row["environment"], row["setting"], row["split"], MODELS[row["model"]]
            names = ("episodes", "goal_reached", "ended_before_first_action", "answers", "right")
            found[key] = Published(*(int(row[name]) for name in names))
        except (KeyError, TypeError, ValueError) as error:
            raise BenchError(f"{path}:{number}: not a row of published runs ({error})") from None
    return found
