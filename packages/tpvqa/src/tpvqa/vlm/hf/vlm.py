"""Models of the transformers library, on this machine."""

import hashlib
import threading
import time
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from tpvqa.errors import AnswerError, PictureError, PluginError
from tpvqa.observation import Frame, Observation
from tpvqa.pictures import in_colour
from tpvqa.questions.question import Question
from tpvqa.vlm.answer import Answer
from tpvqa.vlm.capabilities import NeedsPictures
from tpvqa.vlm.hf.device import AUTO
from tpvqa.vlm.hf.failures import told_plainly
from tpvqa.vlm.hf.family import Asked, Family
from tpvqa.vlm.hf.loading import family_of, load, see_installed
from tpvqa.vlm.hf.quiet import quiet
from tpvqa.vlm.hf.reading import read, together
from tpvqa.vlm.pictures import grey_frame
from tpvqa.vlm.reading import Reading

if TYPE_CHECKING:
    from PIL import Image

BATCH = 16
"""Questions at once where nothing is said."""
_REMEMBERED = 100_000


class HuggingFaceVLM(NeedsPictures):
    """Asks a model that runs here: ViLT, BLIP, or a chat model that takes pictures.

    All questions of a look go through the model in one batch. P(yes) = yes / (yes + no), from the
    classes of ViLT, from how probable BLIP finds each answer, and from the first token of a chat
    model's reply (`Answer.source` is "classes", "likelihood" or "logprobs"); the rest is the
    leftover. Where more than half of it is left over the answer is *unknown*, but a chat model may
    speak on first, and is then read like a server's reply.

    Of several views a chat model sees all at once; a model that takes one picture is asked about
    each, and its log-odds are averaged.

    The model is loaded when it is first needed. The same question about the same pictures is asked
    once.

    Args:
        model: A folder that holds a model or an adapter of `tpvqa train`, or a name on the hub.
        device: auto, cpu, cuda, cuda:N or mps.
        dtype: auto, float32, bfloat16 or float16.
        batch: Questions at once, at most.

    Raises:
        MissingExtraError: torch, transformers or peft is not installed.
    """

    def __init__(
        self, model: str, *, device: str = AUTO, dtype: str = AUTO, batch: int = BATCH
    ) -> None:
        self.model = model
        see_installed(f"The VLM {self.name!r}")
        self._device, self._dtype, self._batch = device, dtype, batch
        self._lock = threading.Lock()
        self._family: Family | None = None
        self._known: OrderedDict[tuple[bytes, str], Reading] = OrderedDict()

    @classmethod
    def from_spec(
        cls, arguments: str, *, device: str = AUTO, dtype: str = AUTO, batch: int = BATCH
    ) -> "HuggingFaceVLM":
        """Make it from `hf:MODEL`.

        Raises:
            PluginError: No model is named.
        """
        if not arguments:
            raise PluginError(
                "'hf' does not say which model. Write hf:FOLDER, or hf:NAME for one of the hub, "
                "e.g. hf:HuggingFaceTB/SmolVLM-256M-Instruct."
            )
        return cls(arguments, device=device, dtype=dtype, batch=batch)

    @property
    def name(self) -> str:
        """ "hf:MODEL"."""
        return f"hf:{self.model}"

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer every question, in order.

        Raises:
            AnswerError: The model cannot be loaded or does not fit into memory, or the observation
                has no picture.
        """
        frames = tuple(observation.frames.values())
        if not frames:
            raise AnswerError(
                f"{self.name} looks at pictures, and this world shows none. Choose a world with "
                "pictures, or a noise model such as oracle:0.9."
            )
        began = time.perf_counter()
        with self._lock:
            readings = self._readings(frames, [question.text for question in questions])
        seconds = (time.perf_counter() - began) / max(1, len(questions))
        return [
            Answer(
                question,
                reading.reply,
                p_yes=reading.p_yes,
                source=reading.source,
                text=reading.text,
                leftover=reading.leftover,
                seconds=seconds,
            )
            for question, reading in zip(questions, readings, strict=True)
        ]

    def check(self) -> None:
        """Load the model, and ask one question about a grey picture, whatever the answer.

        Raises:
            AnswerError: As `ask` does.
        """
        with self._lock:
            self._readings((grey_frame(),), ("Is this picture grey?",))

    def close(self) -> None:
        """Let go of the model. Can be called twice."""
        with self._lock:
            self._family = None

    def _readings(self, frames: Sequence[Frame], texts: Sequence[str]) -> list[Reading]:
        if self._family is None:
            loaded = load(self.model, device=self._device, dtype=self._dtype)
            self._family = family_of(loaded)
        seen = hashlib.blake2b(digest_size=16)
        for frame in frames:
            seen.update(hashlib.blake2b(frame.data).digest())
        picture = seen.digest()
        told = {
            text: self._known[picture, text]
            for text in dict.fromkeys(texts)
            if (picture, text) in self._known
        }
        missing = [text for text in dict.fromkeys(texts) if text not in told]
        if missing:
            told |= self._asked(self._family, frames, missing)
            self._known |= {(picture, text): told[text] for text in missing}
            while len(self._known) > _REMEMBERED:
                self._known.popitem(last=False)
        return [told[text] for text in texts]

    def _asked(
        self, family: Family, frames: Sequence[Frame], texts: Sequence[str]
    ) -> Mapping[str, Reading]:
        """Ask the model."""
        pictures = tuple(_pixels(frame) for frame in frames)
        shown = [pictures] if family.several else [(picture,) for picture in pictures]
        with quiet(), told_plainly(self.name, "asked"):
            views = [
                [
                    reading
                    for at in range(0, len(texts), self._batch)
                    for reading in read(
                        family, [Asked(seen, t) for t in texts[at : at + self._batch]]
                    )
                ]
                for seen in shown
            ]
        return {text: together(of_text) for text, *of_text in zip(texts, *views, strict=True)}

    def _view(self, family: Family, asked: Sequence[Asked]) -> list[Reading]:
        """Ask as much at once as may be."""
        return [
            reading
            for at in range(0, len(asked), self._batch)
            for reading in read(family, asked[at : at + self._batch])
        ]


def _pixels(frame: Frame) -> "Image.Image":
    try:
        return in_colour(frame.data)
    except PictureError as error:
        raise AnswerError(f"The picture {frame.id!r} cannot be read: it {error}") from error
