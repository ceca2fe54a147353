"""The embedded network behind its own endpoint: asked by many, it looks at a picture once."""

import json
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from tests.doubles import worded
from tests.serving.running import INSTRUCTION, body, complete, running
from tpvqa.observation import Frame, Observation
from tpvqa.vlm import Reply
from tpvqa.vlm.chat_completions import read_completion
from tpvqa_household.embedded import EmbeddedVLM
from tpvqa_household.embedded.sessions import Sessions
from tpvqa_household.images.manifest import load_pictures

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


def test_each_picture_is_encoded_once_and_answers_are_those_asked_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shipped = load_pictures()
    pictures = [shipped.read(each) for each in shipped.manifest.pictures[5:325:80]]
    encoded: Counter[bytes] = Counter()
    encode = Sessions.encode

    def counted(sessions: Sessions, pixels: Any) -> Any:
        encoded[pixels.tobytes()] += 1
        return encode(sessions, pixels)

    monkeypatch.setattr(Sessions, "encode", counted)
    asked = [(each, text) for text in QUESTIONS for each in pictures]
    with running(EmbeddedVLM(remember=64)) as serving, ThreadPoolExecutor(16) as pool:
        sent = [
            {**body(f"{text} {INSTRUCTION}", each, logprobs=True, top_logprobs=20), "model": name}
            for name in (serving.model,)
            for each, text in asked
        ]
        replies = list(pool.map(lambda each: complete(serving, each), sent))
        calls = serving.counts.calls
    assert len(encoded) == len(pictures)
    assert set(encoded.values()) == {1}
    assert len(pictures) <= calls <= len(asked)
    alone = EmbeddedVLM()
    for (picture, text), reply in zip(asked, replies, strict=True):
        look = Observation(frames={"front": Frame("a", "front", picture)})
        (right,) = alone.ask(look, [worded(text)])
        found = read_completion(json.dumps(reply.json), text)
        if right.reply is Reply.CANNOT_SEE:
            assert (found.reply, reply.word) == (Reply.UNKNOWN, "cannot see")
        else:
            assert found.reply is right.reply
            assert found.p_yes == pytest.approx(right.p_yes, abs=1e-6)
