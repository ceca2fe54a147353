"""How long the embedded network takes for a picture: `python benchmarks/network.py`.

Pictures are the shipped ones, as JPEG bytes, each asked all questions of a step for the first
time: what is timed is decoding, encoding and answering.
"""

import argparse
import statistics
import time
from pathlib import Path

import numpy as np

from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom
from tpvqa.questions import FactQuestion, Way
from tpvqa_household.embedded import EmbeddedVLM

QUESTIONS = (
    "Is there a plate in the image?",
    "Is the plate in a robot's hand?",
    "Is the plate clean?",
    "Is the bread on the plate?",
    "Is there a fridge in the image?",
    "Is the fridge open?",
    "Is the TV turned on?",
    "Is the apple cut in half?",
)


def main() -> None:
    """Print median and 95th percentile, for one and two threads."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pictures", type=int, default=120)
    given = parser.parse_args()
    import tpvqa_household.images as images

    folder = Path(images.__file__).parent / "data"
    files = sorted(folder.rglob("*.jpg"))[: given.pictures]
    questions = [FactQuestion(text, Way.EFFECT, Atom("asked")) for text in QUESTIONS]
    print(f"{len(files)} pictures, {len(questions)} questions each; ms a picture")
    print(f"{'threads':>8}{'median':>9}{'95 %':>9}")
    for threads in (1, 2):
        vlm = EmbeddedVLM(threads=threads)
        taken = []
        for number, file in enumerate([files[0], *files]):
            frame = Frame(f"{number}", "front", file.read_bytes())
            seen = Observation(look=number, time=0.0, frames={"front": frame})
            began = time.perf_counter()
            answers = vlm.ask(seen, questions)
            taken.append(1000 * (time.perf_counter() - began))
            assert all(answer.p_yes is not None for answer in answers), answers
        timed = taken[1:]  # the first also loads the weights
        print(f"{threads:8}{statistics.median(timed):9.1f}{np.percentile(timed, 95):9.1f}")


if __name__ == "__main__":
    main()
