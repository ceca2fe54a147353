"""A VLM that answers anew at every asking, and a way to keep its answers."""

import random
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

from PIL import Image

from tests.doubles import worded
from tpvqa.observation import Frame, Observation
from tpvqa.questions import Question
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.kept import AnswerFile, KeptVLM, Use
from tpvqa.vlm.kept.vlm import CountingVLM

FRIDGE, PLATE = worded("Is the fridge open?"), worded("Is there a plate?")


class Coin:
    """Yes or no by chance, with a P(yes) that no other answer has."""

    name = "coin"

    def __init__(self, seed: int = 0):
        self._draws = random.Random(seed)
        self.asked: list[str] = []

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        self.asked += [each.text for each in questions]
        p = [self._draws.random() for _ in questions]
        return [
            Answer(each, Reply.YES if x > 0.5 else Reply.NO, p_yes=x, source="coin", seconds=0.25)
            for each, x in zip(questions, p, strict=True)
        ]


def picture(number: int) -> bytes:
    """A small picture, another for each number."""
    data = BytesIO()
    Image.new("RGB", (4, 4), (number % 256, number // 256, 7)).save(data, "PNG")
    return data.getvalue()


def seen(number: int, look: int = 0) -> Observation:
    """A look at such a picture."""
    return Observation(look, frames={"front": Frame(f"{look}", "front", picture(number))})


def keeping(
    path: Path, use: Use, inner: Coin | None, trial: bytes | None = b"trial", spec: str = "coin"
) -> KeptVLM:
    """The VLM with its recorded answers."""
    file = AnswerFile(path, writing=use is not Use.REPLAY)
    model = file.models(spec)[0][0] if use is Use.REPLAY else file.model(spec, {})
    return CountingVLM(file, model, use=use, name=spec, stands_for=Coin, inner=inner, trial=trial)


def said(answers: Sequence[Answer]) -> list[tuple[str, Reply, float | None]]:
    """What was asked and answered."""
    return [(each.question.text, each.reply, each.p_yes) for each in answers]
