"""Which pictures the network takes for unlike its own: `python -m benchmarks.unlike_pictures DATA`.

DATA is a folder that `python -m tpvqa_household.training.render` filled, with parts from seed
900000 on, of both splits: kitchens that neither taught the network nor set where its knowledge
ends. The shipped pictures, made pictures and, with --photographs, real ones follow.
"""

import argparse
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFilter

from tpvqa.bench.statistics import wilson
from tpvqa.errors import TpvqaError
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom, Literal, load_task
from tpvqa.questions import QuestionBook
from tpvqa.questions.question import Question
from tpvqa.tasks import find_task
from tpvqa.vlm import Reply
from tpvqa_household.embedded import EmbeddedVLM
from tpvqa_household.images.manifest import load_pictures
from tpvqa_household.images.sources.photographic import photographed
from tpvqa_household.training import shards
from tpvqa_household.training.labelled import COLUMNS, read_labelled
from tpvqa_household.training.likeness_fit import EDGE_FROM
from tpvqa_household.training.recipe import Recipe

Pixels = NDArray[np.uint8]
SIDE = 224
MADE = 200
"""Pictures of each made kind."""
_EVERY = 4
_RESAMPLES = 1000


def _jpeg(image: Image.Image) -> Image.Image:
    buffer = BytesIO()
    image.save(buffer, "JPEG", quality=15)
    return Image.open(buffer).convert("RGB")


def _noisy(image: Image.Image, seed: int) -> Image.Image:
    noise = np.random.default_rng(seed).normal(0, 20, (*image.size[::-1], 3))
    return Image.fromarray(np.clip(np.asarray(image) + noise, 0, 255).astype(np.uint8))


def _lit(image: Image.Image, gain: float, lift: float = 0.0) -> Image.Image:
    light = np.clip(np.asarray(image, np.float64) * gain + lift, 0, 255)
    return Image.fromarray(light.astype(np.uint8))


WORSE: dict[str, Callable[[Image.Image, int], Image.Image]] = {
    "as they are": lambda image, seed: image,
    "by another camera": photographed,
    "dark, 0.35 of the light": lambda image, seed: _lit(image, 0.35),
    "dark, 0.15 of the light": lambda image, seed: _lit(image, 0.15),
    "overexposed, 1.6 of the light": lambda image, seed: _lit(image, 1.6, 20),
    "blurred, 2 pixels": lambda image, seed: image.filter(ImageFilter.GaussianBlur(2)),
    "blurred, 4 pixels": lambda image, seed: image.filter(ImageFilter.GaussianBlur(4)),
    "noise of 20 levels": _noisy,
    "80 × 80 pixels": lambda image, seed: image.resize((80, 80), Image.Resampling.BOX),
    "JPEG, quality 15": lambda image, seed: _jpeg(image),
}
"""What becomes of a kitchen's pictures."""


def _colour(rng: np.random.Generator) -> tuple[int, int, int]:
    red, green, blue = rng.integers(0, 256, 3).tolist()
    return red, green, blue


def _box(rng: np.random.Generator) -> list[int]:
    left, right, top, bottom = (
        *sorted(rng.integers(0, SIDE, 2)),
        *sorted(rng.integers(0, SIDE, 2)),
    )
    return [int(left), int(top), int(right), int(bottom)]


def _blank(rng: np.random.Generator) -> Image.Image:
    return Image.new("RGB", (SIDE, SIDE), _colour(rng))


def _gradient(rng: np.random.Generator) -> Image.Image:
    turn = rng.uniform(0, 2 * np.pi)
    rows, columns = np.mgrid[0 : 1 : SIDE * 1j, 0 : 1 : SIDE * 1j]
    along = columns * np.cos(turn) + rows * np.sin(turn)
    along = ((along - along.min()) / np.ptp(along))[..., None]
    mixed = np.array(_colour(rng)) * along + np.array(_colour(rng)) * (1 - along)
    return Image.fromarray(mixed.astype(np.uint8))


def _noise(rng: np.random.Generator) -> Image.Image:
    small = int(SIDE // rng.choice([1, 2, 4, 8]))
    grains = Image.fromarray(rng.integers(0, 256, (small, small, 3), dtype=np.uint8))
    return grains.resize((SIDE, SIDE), Image.Resampling.NEAREST)


def _two_colours(rng: np.random.Generator) -> Image.Image:
    image, kind = _blank(rng), int(rng.integers(3))
    draw, colour = ImageDraw.Draw(image), _colour(rng)
    if kind == 0:
        draw.rectangle([0, int(rng.integers(20, SIDE - 20)), SIDE, SIDE], fill=colour)
    elif kind == 1:
        draw.ellipse(_box(rng), fill=colour)
    else:
        stripes = int(rng.integers(2, 20))
        for stripe in range(0, stripes, 2):
            edges = SIDE * stripe // stripes, SIDE * (stripe + 1) // stripes
            draw.rectangle([edges[0], 0, edges[1], SIDE], fill=colour)
    return image


def _drawing(rng: np.random.Generator) -> Image.Image:
    """Lines and flat shapes, on white paper mostly."""
    image = Image.new("RGB", (SIDE, SIDE), "white" if rng.random() < 0.6 else _colour(rng))
    draw = ImageDraw.Draw(image)
    for _ in range(int(rng.integers(3, 14))):
        fill = _colour(rng) if rng.random() < 0.5 else None
        width, kind = int(rng.integers(1, 5)), int(rng.integers(3))
        if kind == 0:
            draw.rectangle(_box(rng), fill=fill, outline="black", width=width)
        elif kind == 1:
            draw.ellipse(_box(rng), fill=fill, outline="black", width=width)
        else:
            draw.line(rng.integers(0, SIDE, 4).tolist(), fill="black", width=width)
    return image


def _page(rng: np.random.Generator) -> Image.Image:
    image = Image.new("RGB", (SIDE, SIDE), "white")
    draw = ImageDraw.Draw(image)
    for top in range(5, SIDE, 12):
        draw.text((5, top), "".join(rng.choice(list("abcdefghij klmno pqrst"), 36)), fill="black")
    return image


KINDS: dict[str, Callable[[np.random.Generator], Image.Image]] = {
    "blank": _blank,
    "gradient": _gradient,
    "noise": _noise,
    "two colours": _two_colours,
    "drawings of lines and shapes": _drawing,
    "a page of text": _page,
}
"""Pictures that show nothing of a kitchen."""


def made(kind: str, count: int) -> list[Image.Image]:
    """Made pictures of a kind, the same each time."""
    return [KINDS[kind](np.random.default_rng([7, number])) for number in range(count)]


def frame(image: Image.Image) -> Frame:
    """A picture as a camera's."""
    buffer = BytesIO()
    image.save(buffer, "PNG", compress_level=1)
    return Frame("picture", "front", buffer.getvalue(), "image/png")


def _kitchens(folder: Path, split: str, seeds: range) -> Iterator[tuple[int, Image.Image]]:
    for path in shards.finished(folder, split):
        if int(path.stem.rsplit("-", 1)[1]) in seeds:
            shard = shards.read(path)
            for info, pixels in zip(shard.info, shard.pixels, strict=True):
                yield int(info["kitchen"]), Image.fromarray(pixels)


def by_kitchen(kitchens: Sequence[int], hits: Sequence[bool]) -> str:
    """A share with its 95 % interval, by the bootstrap over kitchens."""
    names, places = np.unique(kitchens, return_inverse=True)
    counts = np.bincount(places)
    found = np.bincount(places, weights=np.array(hits, float))
    rng = np.random.default_rng(0)
    drawn = rng.integers(0, len(names), (_RESAMPLES, len(names)))
    low, high = np.quantile(found[drawn].sum(1) / counts[drawn].sum(1), [0.025, 0.975])
    return f"{np.mean(hits):.4f} ({low:.4f}–{high:.4f}) | {len(hits)} of {len(names)} kitchens"


def _share(hits: Iterable[bool]) -> str:
    counted = list(hits)
    rate = wilson(sum(counted), len(counted))
    return f"{rate.rate:.3f} ({rate.low:.3f}–{rate.high:.3f}) | {len(counted)}"


def questions() -> list[Question]:
    """What the heads for photographs answer."""
    book = QuestionBook.load(find_task("serve_breakfast").questions, load_task("serve_breakfast"))
    return [book.fact(Literal(Atom(x.name, x.arguments), True)) for x in COLUMNS]


def tables(data: Path, photographs: Path | None) -> Iterator[str]:
    """Markdown, line by line."""
    vlm, first = EmbeddedVLM(remember=1), Recipe.read().validation_from
    yield "| kitchens | pictures | taken for unlike | pictures |"
    yield "|---|---|---|---|"
    parts = {"held_out": range(first, first + EDGE_FROM), "train": range(first, 1_000_000)}
    meshes = {"held_out": "meshes never seen", "train": "known meshes"}
    for split, seeds in parts.items():
        pictures = list(_kitchens(data, split, seeds))
        if not pictures:
            raise TpvqaError(f"{data} has no kept kitchens of split {split}: render some.")
        for worse, make in WORSE.items():
            some = pictures if worse == "as they are" else pictures[::_EVERY]
            hits = [not vlm.knows(frame(make(p, n))) for n, (_, p) in enumerate(some)]
            yield f"| {meshes[split]} | {worse} | {by_kitchen([k for k, _ in some], hits)} |"
    shipped = load_pictures()
    opened = [
        Image.open(BytesIO(shipped.read(p))).convert("RGB") for p in shipped.manifest.pictures
    ]
    for worse, make in WORSE.items():
        hits = [not vlm.knows(frame(make(p, n))) for n, p in enumerate(opened)]
        yield f"| the shipped pictures | {worse} | {_share(hits)} |"
    yield ""
    yield "| pictures | taken for unlike | pictures | questions answered |"
    yield "|---|---|---|---|"
    others = {kind: made(kind, MADE) for kind in KINDS}
    if photographs is not None:
        real = read_labelled(photographs, "test").pixels
        others["real photographs"] = [Image.fromarray(pixels) for pixels in real]
    asked = questions()
    for kind, images in others.items():
        frames = [frame(image) for image in images]
        looks = [Observation(0, 0.0, {"front": each}) for each in frames]
        answers = [answer for look in looks for answer in vlm.ask(look, asked)]
        told = np.mean([answer.reply is not Reply.UNKNOWN for answer in answers])
        yield f"| {kind} | {_share(not vlm.knows(each) for each in frames)} | {told:.3f} |"


def main() -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("data", type=Path, help="rendered pictures, parts from 900000 on")
    parser.add_argument("--photographs", type=Path, help="with a labels.csv; its part test is used")
    given = parser.parse_args()
    try:
        for line in tables(given.data, given.photographs):
            print(line, flush=True)
    except TpvqaError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
