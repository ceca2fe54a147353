"""What a server is told besides pictures and questions: a file that can be read and replaced."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path

import yaml

from tpvqa.errors import PictureError, PromptError
from tpvqa.observation import Frame
from tpvqa.pictures import picture_type, read_picture, upright
from tpvqa.text_files import read_text
from tpvqa.yaml_places import Place, read_yaml

SHIPPED = Path(__file__).with_name("prompt.yaml")
MOST_EXAMPLES = 16
_SLOTS = {
    "system": (),
    "question": ("question",),
    "together": ("questions", "keys"),
    "views": (),
    "before_after": ("before", "after"),
}


@dataclass(frozen=True, slots=True)
class Example:
    """A question with its pictures and the right answer, shown before the real one."""

    pictures: tuple[Frame, ...]
    question: str
    answer: str


@dataclass(frozen=True, slots=True)
class Prompt:
    """The words around a question.

    Attributes:
        system: Said before everything; empty for nothing.
        question: One question, with the slot {question}.
        together: Many, with {questions} and {keys}.
        views: Before it, where there are several pictures; may hold {pictures}.
        before_after: Before it, where pictures from before the action are there: {before}, {after}.
        examples: Turns before the question.
        digest: Of all of this, pictures included.
    """

    system: str
    question: str
    together: str
    views: str
    before_after: str
    examples: tuple[Example, ...]
    digest: str

    def one(self, question: str, *, pictures: int, before: int) -> str:
        """The text of a request with one question."""
        asked = _filled(self.question, question=question)
        return self._introduced(asked, pictures, before)

    def many(self, questions: Sequence[str], *, pictures: int, before: int) -> str:
        """The text of a request with several questions, whose keys are q1, q2, …"""
        keys = [f"q{at}" for at in range(1, len(questions) + 1)]
        listed = "\n".join(f"{key}: {text}" for key, text in zip(keys, questions, strict=True))
        asked = _filled(self.together, questions=listed, keys=", ".join(keys))
        return self._introduced(asked, pictures, before)

    def _introduced(self, asked: str, pictures: int, before: int) -> str:
        if before:
            told = _filled(self.before_after, before=str(before), after=str(pictures - before))
        elif pictures > 1:
            told = _filled(self.views, pictures=str(pictures))
        else:
            told = ""
        return f"{told} {asked}".strip()


def _filled(text: str, **slots: str) -> str:
    """A text with its slots filled in, once: what is filled in is not looked through."""
    return re.sub(r"\{(\w+)\}", lambda found: slots.get(found[1], found[0]), text)


@cache
def shipped_prompt() -> Prompt:
    """The prompt that is used where none is named."""
    return load_prompt(SHIPPED)


def load_prompt(path: Path) -> Prompt:
    """Read a prompt. What a file leaves out is as in the shipped one.

    Raises:
        PromptError: It cannot be read, or something in it is wrong; says where.
    """
    top = read_yaml(path, PromptError)
    if top is None:
        raise PromptError("says nothing; begin with what `tpvqa prompt` prints", file=path)
    parts = top.sections("schema", *_SLOTS, "examples")
    if "schema" in parts and str(getattr(parts["schema"].node, "value", "")) != "1":
        raise parts["schema"].wrong("this version reads 1")
    texts = {name: _text(name, parts[name]) for name in _SLOTS if name in parts}
    if path != SHIPPED:
        texts = {name: getattr(shipped_prompt(), name) for name in _SLOTS} | texts
    elif len(texts) < len(_SLOTS):
        raise PromptError("is not whole", file=path)
    listed = list(parts["examples"].items()) if "examples" in parts else []
    if len(listed) > MOST_EXAMPLES:
        raise parts["examples"].wrong(f"{len(listed)} examples; at most {MOST_EXAMPLES} are sent")
    examples = tuple(_example(each, path.parent) for each in listed)
    told = repr(
        (
            sorted(texts.items()),
            [
                (e.question, e.answer, [sha256(p.data).hexdigest() for p in e.pictures])
                for e in examples
            ],
        )
    )
    return Prompt(**texts, examples=examples, digest=sha256(told.encode()).hexdigest()[:16])


def shipped_text() -> str:
    """The text of the shipped file."""
    return read_text(SHIPPED, PromptError)


def _text(name: str, place: Place) -> str:
    node = place.node
    if not isinstance(node, yaml.ScalarNode) or node.tag != "tag:yaml.org,2002:str":
        raise place.wrong("expected text; write it in quotes")
    said = str(node.value)
    for slot in _SLOTS[name]:
        if f"{{{slot}}}" not in said:
            raise place.wrong(f"has to hold {{{slot}}}, which is filled in")
    return said


def _example(place: Place, folder: Path) -> Example:
    parts = place.sections("pictures", "question", "answer")
    for name in ("pictures", "question", "answer"):
        if name not in parts:
            raise place.wrong(f"an example has {name}, too")
    answer = str(getattr(parts["answer"].node, "value", "")).lower()
    if answer not in ("yes", "no"):
        raise parts["answer"].wrong("expected yes or no")
    frames = []
    for number, each in enumerate(parts["pictures"].texts()):
        name = each.text()
        try:
            data = upright(read_picture(folder / name))
            frames.append(Frame(name, f"example{number}", data, picture_type(data)))
        except PictureError as error:
            raise each.wrong(f"{error} (paths are relative to this file)") from error
    if not frames:
        raise parts["pictures"].wrong("an example has a picture at least")
    return Example(tuple(frames), parts["question"].text(), answer)
