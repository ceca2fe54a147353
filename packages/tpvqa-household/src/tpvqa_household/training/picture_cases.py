"""The pictures that the images world draws from, as cases to score a VLM on."""

from collections.abc import Iterator

from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom
from tpvqa_household.images.manifest import PictureSet
from tpvqa_household.training.scoring import Case

GROUPS = {"known": "known meshes", "held_out": "held-out meshes"}


def picture_cases(pictures: PictureSet) -> Iterator[Case]:
    """Every picture of a set with what is true and visible in it, by kind of meshes."""
    facts = {text: Atom.parse(text) for text in pictures.manifest.facts}
    for meshes, group in GROUPS.items():
        for number, picture in enumerate(pictures.manifest.pictures):
            if picture.meshes != meshes:
                continue
            frame = Frame(
                id=picture.file.removesuffix(".jpg"),
                view="front",
                data=pictures.read(picture),
                source=picture.file,
            )
            true = set(picture.state)
            yield Case(
                Observation(number, 0.0, {"front": frame}),
                {atom: (text in true, text in picture.seen) for text, atom in facts.items()},
                group,
            )
