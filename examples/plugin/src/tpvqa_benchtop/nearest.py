"""A VLM for any domain with labelled pictures: what held in those that look most like this one.

It knows nothing of words: it answers about the fact that a question is about, and about nothing
else. For a domain with few states and one camera that is enough, and it needs no server.
"""

from collections.abc import Sequence
from hashlib import sha256
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tpvqa.errors import PluginError
from tpvqa.observation import Observation
from tpvqa.pictures import read_file
from tpvqa.questions import FactQuestion, Question
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.capabilities import FactsOnly, NeedsPictures
from tpvqa.worlds.pictures import MANIFEST, Manifest, Picture
from tpvqa.worlds.pictures.manifest import read_manifest

_SMALL = (48, 36)  # pixels: more is noise
_NEIGHBOURS = 5


class Nearest(NeedsPictures, FactsOnly):
    """Answers by the labelled pictures that look most like what is seen.

    A picture that is among the labelled ones is not compared with itself: what is measured on the
    set it learnt from is measured as on new pictures.

    Args:
        folder: Pictures with a manifest, as for `--world pictures:FOLDER`.
    """

    def __init__(self, folder: Path):
        self.name = f"nearest:{folder}"
        manifest = read_manifest(
            folder,
            Manifest[Picture],
            missing="Name a folder of labelled pictures",
            broken="Mend it",
        )
        self._known = manifest.pictures
        self._pixels = np.stack(
            [_pixels(read_file(each.file, inside=folder)) for each in self._known]
        )

    @classmethod
    def from_spec(cls, arguments: str) -> "Nearest":
        """Make it from `nearest:FOLDER`."""
        if not arguments:
            raise PluginError(f"Write nearest:FOLDER, where FOLDER holds pictures and {MANIFEST}.")
        return cls(Path(arguments))

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer each question by the same few pictures."""
        (frame, *_) = observation.frames.values()
        distances = ((self._pixels - _pixels(frame.data)) ** 2).mean(axis=1)
        own = sha256(frame.data).hexdigest()
        same = np.array([each.sha256 == own for each in self._known])
        order = np.argsort(np.where(same, np.inf, distances))[:_NEIGHBOURS]
        return [self._answer(question, order, distances) for question in questions]

    def _answer(
        self, question: Question, order: NDArray[np.intp], distances: NDArray[np.float64]
    ) -> Answer:
        if not isinstance(question, FactQuestion):
            return Answer(question, Reply.UNKNOWN, text="only facts are known here")
        yes = no = 0.1  # how sure it may be with so few pictures
        for number in order:
            near = float(np.exp(-distances[number] / distances[order[0]]))
            shown = self._known[number]
            if not all(map(shown.shows_fact, question.atoms)):
                continue
            if question.true_in(shown.holds):
                yes += near
            else:
                no += near
        if yes == no:
            return Answer(question, Reply.CANNOT_SEE, p_cannot_see=1.0)
        p = yes / (yes + no)
        return Answer(question, Reply.YES if p > 0.5 else Reply.NO, p_yes=p, source="pictures")


def _pixels(data: bytes) -> NDArray[np.float64]:
    """A picture as a vector: small, and of the same brightness as any other."""
    image = Image.open(BytesIO(data)).convert("RGB").resize(_SMALL)
    pixels = np.asarray(image, dtype=np.float64)
    flat: NDArray[np.float64] = (pixels / pixels.mean()).ravel()
    return flat
