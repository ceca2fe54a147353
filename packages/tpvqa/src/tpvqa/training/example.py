"""What a VLM is taught with: a picture, a question, and whether yes is right."""

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property


@dataclass(frozen=True)
class Example:
    """A question about a picture, with its right answer.

    Attributes:
        data: The encoded picture.
        media_type: What it is encoded as.
        text: The question.
        truth: Whether yes is right.
        predicate: What it asks about.
        group: Tells pictures of one scene, taken together, from others; "" for one by itself.
    """

    data: bytes = field(repr=False)
    media_type: str
    text: str
    truth: bool
    predicate: str = ""
    group: str = ""

    @cached_property
    def picture(self) -> str:
        """Tells its picture from others, by its content."""
        return hashlib.blake2b(self.data, digest_size=16).hexdigest()

    @property
    def together(self) -> str:
        """What is never taken apart: its group, or else its picture."""
        return f"group {self.group}" if self.group else self.picture


def consistent(examples: Iterable[Example]) -> list[Example]:
    """Each question about a picture once; none of those that have both answers."""
    found: dict[tuple[str, str], Example] = {}
    torn = set()
    for each in examples:
        key = each.picture, each.text
        if found.setdefault(key, each).truth != each.truth:
            torn.add(key)
    return [each for key, each in found.items() if key not in torn]
