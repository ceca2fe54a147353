"""Pictures of random kitchens in random states, for training; also run by `python -m`."""

import argparse
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tpvqa.chance import chance_array
from tpvqa.pddl import Atom, State
from tpvqa_household.kitchen.layout import Split
from tpvqa_household.kitchen.scene import KitchenScene
from tpvqa_household.kitchen.states import sample_state
from tpvqa_household.kitchen.truth import Shown

KITCHEN = 40
"""Pictures of one kitchen before the next is built."""


@dataclass(frozen=True)
class Picture:
    """A picture and all that is known about it.

    Attributes:
        pixels: size × size × 3.
        state: What is true.
        shown: What is true, and what the picture shows, for every fact.
        info: Kitchen, view and how many pixels show each thing.
    """

    pixels: NDArray[np.uint8]
    state: State
    shown: Mapping[Atom, Shown]
    info: Mapping[str, object]


def pictures(
    seed: int, n: int, split: Split = "train", *, size: int = 224, overview: float = 0.04
) -> Iterator[Picture]:
    """Draw `n` pictures; a new kitchen every 40, other colours and lights in each.

    Args:
        seed: Decides everything; other seeds give other kitchens.
        n: How many.
        split: Which meshes, grippers and layouts.
        size: Height and width, pixels.
        overview: Share of pictures of the whole room.
    """
    scene: KitchenScene | None = None
    try:
        for number in range(n):
            if number % KITCHEN == 0:
                if scene is not None:
                    scene.close()
                kitchen = int(chance_array(seed, 0, "kitchens", split, number).integers(2**40))
                scene = KitchenScene(seed=kitchen, split=split, size=size)
            assert scene is not None
            rng = chance_array(seed, 0, "picture", split, number)
            state = sample_state(rng)
            draw = rng.random()
            view = "front" if draw > 0.3 else "overview" if draw < overview else None
            view = view or ("left" if rng.random() < 0.5 else "right")
            scene.repaint(number)
            scene.arrange(state, look=number, view=view)
            info = {
                "kitchen": kitchen,
                "view": view,
                "wrong": scene.wrong,
                "pixels": dict(scene.pixels()),
            }
            yield Picture(scene.render(), state, scene.shown(), info)
    finally:
        if scene is not None:
            scene.close()


def main() -> None:
    """Write pictures and what they show to a folder."""
    import json

    from PIL import Image

    parser = argparse.ArgumentParser(description="Draws pictures of random kitchens.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("-n", type=int, default=40)
    parser.add_argument("--split", choices=["train", "held_out"], default="train")
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    with (given.folder / "facts.jsonl").open("w", encoding="utf-8") as facts:
        for k, picture in enumerate(pictures(given.seed, given.n, given.split)):
            Image.fromarray(picture.pixels).save(given.folder / f"{k:05d}.jpg", quality=90)
            shown = {str(a): [s.true, s.visible] for a, s in picture.shown.items()}
            row = {"shown": shown, "info": picture.info}
            facts.write(json.dumps(row) + "\n")


if __name__ == "__main__":
    main()
