"""Teach a network its limits: `python -m tpvqa_household.training.limits --help`.

Adds to an exported network where its knowledge ends, and the frozen branch that answers about real
photographs beyond. The network itself stays as it is. Run it after every export.
"""

import argparse
import hashlib
import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from PIL import Image, ImageFilter

from tpvqa.chance import chance_array
from tpvqa.errors import TpvqaError
from tpvqa_household.embedded.lexicon import Unknown
from tpvqa_household.embedded.likeness import Divide, Floats, Likeness, summary
from tpvqa_household.embedded.limits import described
from tpvqa_household.embedded.sessions import Sessions
from tpvqa_household.embedded.weights import DESCRIPTION, FROZEN, LIMITS, SHIPPED, Weights
from tpvqa_household.images.manifest import load_pictures
from tpvqa_household.training.asking import Asking
from tpvqa_household.training.augment import augmented
from tpvqa_household.training.cutouts import Cutout, pasted, read_cutouts
from tpvqa_household.training.data import Pictures
from tpvqa_household.training.graphs import written
from tpvqa_household.training.imagenet import ImageNetBranch, Seen
from tpvqa_household.training.labelled import COLUMNS, Labelled, read_labelled, squeezed
from tpvqa_household.training.labels import Label
from tpvqa_household.training.likeness_fit import (
    EDGE_FROM,
    divide,
    ending,
    fitted,
    reaching,
)
from tpvqa_household.training.network import SIDE
from tpvqa_household.training.photo_heads import Heads, Taught, taught
from tpvqa_household.training.recipe import Recipe
from tpvqa_household.training.subjects import Subject
from tpvqa_household.training.wordings import wordings

FALSE_ALARMS = 0.01
"""Share of the pictures of held-out kitchens, with meshes never seen, that are taken for unlike at
most: two in five as they are, two by other cameras, one in other light."""
UNNATURAL = 0.05
"""Share of the photographs held back that are taken for no photographs."""
SURE = 0.9
"""The probability from which on a head is sure."""
_TAUGHT = range(20)
_DIRECTIONS, _TEXTURES = 64, 16
_SHIPPED = 4
"""How often each shipped picture counts beside one of the training's renderer."""
_VARIANTS = 4
_PASTED = 1500
"""Pictures with cut-outs of each kind."""
_EVERY = 4
_FOLDS = 5
SUBJECTS = tuple(COLUMNS)
_NEEDS = {"opened": "near", "turned_on": "near"}


def _worse(pixels: NDArray[np.uint8], seed: int, purpose: str) -> NDArray[np.uint8]:
    """The pictures as other cameras might have taken them."""
    rng = chance_array(seed, 0, "limits", purpose)
    parts = []
    for first in range(0, len(pixels), 50):
        changed = augmented(np.ascontiguousarray(pixels[first : first + 50]), rng)
        parts.append((changed.permute(0, 2, 3, 1) * 128 + 127).round().clamp(0, 255).byte().numpy())
    return np.concatenate(parts)


def _lit(pixels: NDArray[np.uint8], seed: int, purpose: str) -> NDArray[np.uint8]:
    """The pictures with a third to nearly twice the light, some out of focus."""
    rng = chance_array(seed, 0, "light", purpose)
    changed = []
    for picture in pixels:
        gain, lift = np.exp(rng.uniform(np.log(0.3), np.log(1.8))), rng.uniform(0, 20)
        blurred, radius = rng.random() < 0.3, rng.uniform(0, 2)
        exposed = Image.fromarray(np.clip(picture * gain + lift, 0, 255).astype(np.uint8))
        if blurred:
            exposed = exposed.filter(ImageFilter.GaussianBlur(radius))
        changed.append(np.asarray(exposed))
    return np.stack(changed)


def _both(pixels: NDArray[np.uint8], seed: int, purpose: str) -> NDArray[np.uint8]:
    return np.concatenate([pixels, _worse(pixels, seed, purpose)])


def _by_any_camera(pixels: NDArray[np.uint8], seed: int, purpose: str) -> NDArray[np.uint8]:
    return np.concatenate([_both(pixels, seed, purpose), _lit(pixels[::2], seed, purpose)])


def _summaries(sessions: Sessions, pixels: NDArray[np.uint8]) -> Floats:
    return np.stack([summary(sessions.encode(picture)) for picture in pixels])


def known_pictures(
    sessions: Sessions, known: Pictures, other: Pictures, photographs: Labelled, seed: int
) -> tuple[Likeness, Divide]:
    """Where the pictures that the network knows end.

    The pictures that ship, by another renderer, count among them: it is known how well they are
    answered, and trials are made of them.

    Args:
        sessions: The network.
        known: Kitchens of the training.
        other: Kitchens that neither taught nor will measure, with meshes never seen.
        photographs: What lies beyond.
        seed: Decides how pictures are made worse.

    Returns:
        The likeness to what it knows, and a plane between that and photographs. Each takes half of
        `FALSE_ALARMS`.
    """

    def summaries(pixels: NDArray[np.uint8], purpose: str) -> Floats:
        return _summaries(sessions, _by_any_camera(pixels, seed, purpose))

    as_they_are = _shipped()
    shipped = summaries(as_they_are, "shipped")
    rendered = summaries(known.pixels(np.arange(len(known))), "known")
    kitchens = np.concatenate([rendered, *[shipped] * _SHIPPED])
    held_out = summaries(other.pixels(np.arange(len(other))), "held out")
    beyond = _summaries(sessions, _both(photographs.pixels, seed, "photographs"))
    likeness, share = fitted(kitchens, directions=_DIRECTIONS), FALSE_ALARMS / 2
    edged = ending(likeness, likeness.distance(held_out), share)
    return (
        reaching(edged, edged.distance(shipped[: len(as_they_are)])),
        divide(kitchens, beyond, held_out, share),
    )


def _shipped() -> NDArray[np.uint8]:
    pictures = load_pictures()
    return np.stack([squeezed(pictures.folder / p.file) for p in pictures.manifest.pictures])


def natural_pictures(texture: Floats, groups: NDArray[np.str_]) -> Likeness:
    """Where photographs end, by those whose group did not teach it."""
    distances = np.zeros(len(texture))
    names = np.unique(groups)
    for fold in range(_FOLDS):
        out = np.isin(groups, names[fold::_FOLDS])
        distances[out] = fitted(texture[~out], directions=_TEXTURES).distance(texture[out])
    return ending(fitted(texture, directions=_TEXTURES), distances, UNNATURAL)


def heads(
    branch: ImageNetBranch,
    photographs: Labelled,
    known: Pictures,
    cutouts: Sequence[Cutout],
    seed: int,
) -> tuple[Heads, Seen]:
    """The heads, and what the branch makes of the photographs.

    Args:
        branch: What sees for the heads.
        photographs: Those that teach.
        known: Kitchens of the training.
        cutouts: Things of the photographs, pasted into kitchens and into other photographs.
        seed: Decides how pictures are made worse, and what is pasted where.
    """
    variants = [photographs.pixels]
    variants += [_worse(photographs.pixels, seed, f"variant {n}") for n in range(_VARIANTS)]
    real = [Taught(branch.see(p), photographs.labels, photographs.groups) for p in variants]
    some = np.arange(0, len(known), _EVERY)
    labels = np.select(
        [known.labels == Label.YES, np.isin(known.labels, (Label.NO, Label.HARD_NO))], [1, 0], -1
    )
    rendered = _both(known.pixels(some), seed, "kitchens of the heads")
    kitchens = Taught(branch.see(rendered), np.concatenate([labels[some]] * 2))
    with_cutouts = {}
    if cutouts:
        others = np.arange(1, len(known), _EVERY // 2)
        nobody = np.full(len(others), "")
        scenes = {
            "kitchens": (known.pixels(others), labels[others], nobody),
            "photographs": (photographs.pixels, photographs.labels, photographs.groups),
        }
        for kind, scene in scenes.items():
            made = pasted(*scene, cutouts, count=_PASTED, seed=seed)
            halves = [made.pixels[::2], _worse(made.pixels[1::2], seed, f"cut-outs in {kind}")]
            order = np.argsort(np.r_[0:_PASTED:2, 1:_PASTED:2])
            see = branch.see(np.concatenate(halves)[order])
            with_cutouts[kind] = Taught(see, made.labels, made.groups)
    return taught(SUBJECTS, real, [kitchens], with_cutouts), real[0].seen


def _asked(subject: Subject, weights: Weights) -> list[tuple[str, bool]]:
    """All wordings of a subject as the lexicon has them."""
    found = []
    for wording in wordings(subject):
        tokens = weights.lexicon.tokens(wording.text)
        if not isinstance(tokens, Unknown):
            text = " ".join(weights.lexicon.vocabulary[token - 1] for token in tokens)
            found.append((text, wording.inverted))
    return list(dict.fromkeys(found))


def _write(
    weights: Weights, branch: ImageNetBranch, arrays: dict[str, Floats], told: dict[str, object]
) -> None:
    """Write branch and limits, and last the description that names them."""
    folder = weights.folder
    pixels = torch.zeros(1, SIDE, SIDE, 3, dtype=torch.uint8)
    written(branch, (pixels,), folder / FROZEN, ["pixels"], ["features", "classes", "texture"], {})
    with (folder / f"{LIMITS}.tmp").open("wb") as file:
        np.savez(file, allow_pickle=False, **arrays)
    os.replace(folder / f"{LIMITS}.tmp", folder / LIMITS)
    data = dict(weights.description)
    hashes = {n: hashlib.sha256((folder / n).read_bytes()).hexdigest() for n in (FROZEN, LIMITS)}
    data["sha256"] = {**data["sha256"], **hashes}
    data["limits"] = told
    fresh = folder / f"{DESCRIPTION}.tmp"
    fresh.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    os.replace(fresh, folder / DESCRIPTION)


def _report(fit: Heads, photographs: Labelled) -> str:
    """Of photographs held back: how many a head is sure of, and how often it is right then."""
    lines = [
        "| fact | yes | no | sure | right where sure | cut-outs in |",
        "|---|---|---|---|---|---|",
    ]
    edge = np.log(SURE / (1 - SURE))
    for column, subject in enumerate(SUBJECTS):
        odds, label = fit.held_back[:, column], photographs.labels[:, column]
        asked = (label >= 0) & ~np.isnan(odds)
        sure = asked & (np.abs(odds) >= edge)
        right = (odds > 0) == (label == 1)
        counts = f"{int((label == 1).sum())} | {int((label == 0).sum())}"
        rates = "– | –"
        if sure.any():
            rates = f"{sure.sum() / asked.sum():.2f} | {right[sure].mean():.2f}"
        lines.append(f"| {subject} | {counts} | {rates} | {fit.helped[column] or '–'} |")
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """Find the limits, write them, and say how the heads did on photographs held back."""
    parser = argparse.ArgumentParser(
        prog="python -m tpvqa_household.training.limits",
        description=(__doc__ or "").splitlines()[0],
    )
    parser.add_argument(
        "photographs", type=Path, help="a folder with a labels.csv; part train teaches"
    )
    parser.add_argument("pictures", type=Path, help="the folder that `render` filled, both splits")
    parser.add_argument("--weights", type=Path, default=SHIPPED, help="the exported network")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1)
    chosen = parser.parse_args(arguments)
    torch.set_num_threads(chosen.threads)
    try:
        weights = Weights.read(chosen.weights)
        recipe = Recipe.read()
        about = (SUBJECTS, Asking.about(recipe.task).actions)
        edge = range(recipe.validation_from + EDGE_FROM, 1_000_000)
        known = Pictures(chosen.pictures, "train", *about, seeds=_TAUGHT)
        other = Pictures(chosen.pictures, "held_out", *about, seeds=edge)
        for name, kitchens in (("train", known), ("held_out", other)):
            if not kitchens.refresh():
                raise TpvqaError(f"{chosen.pictures} has no kitchens of split {name}: render some.")
        photographs = read_labelled(chosen.photographs, "train")
        branch = ImageNetBranch().rounded()
        print(
            f"{len(known)} pictures of kitchens, {len(photographs.files)} photographs", flush=True
        )
        cutouts = read_cutouts(chosen.photographs, photographs)
        print(f"{len(cutouts)} cut-outs of them", flush=True)
        fit, seen = heads(branch, photographs, known, cutouts, chosen.seed)
        print(_report(fit, photographs), flush=True)
        sessions = Sessions(weights, threads=chosen.threads)
        likeness, plane = known_pictures(sessions, known, other, photographs, chosen.seed)
        arrays = {
            **likeness.arrays("known"),
            **plane.arrays("photographic"),
            **natural_pictures(seen.texture, photographs.groups).arrays("natural"),
            "heads.features": fit.features,
            "heads.classes": fit.classes,
            "heads.bias": fit.bias,
        }
        told = described(
            [(str(s), _needed(s), _asked(s, weights)) for s in SUBJECTS],
            sure=round(float(np.log(SURE / (1 - SURE))), 4),
        )
        told["taught"] = {
            "seed": chosen.seed,
            "photographs": len(photographs.files),
            "cutouts": len(cutouts),
            "kitchens": len(known),
            "held_out": len(other),
            "false_alarms": FALSE_ALARMS,
        }
        _write(weights, branch, arrays, told)
    except (TpvqaError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def _needed(subject: Subject) -> str | None:
    needs = _NEEDS.get(subject.name)
    return None if needs is None else str(Subject("fact", needs, subject.arguments))


if __name__ == "__main__":
    sys.exit(main())
