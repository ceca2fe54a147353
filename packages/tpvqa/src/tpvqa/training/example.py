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


def consistent(examples: Iterable[Example]) -> list[Example]:
    """Each question about a picture once; none of those that have both answers."""
    found: dict[tuple[str, str], Example] = {}
    torn = set()
    for each in examples:
        key = each.picture, each.text
        if found.setdefault(key, each).truth != each.truth:
            torn.add(key)
    return [each for key, each in found.items() if key not in torn]


def together(examples: Iterable[Example]) -> dict[str, str]:
    """For each picture a name that it shares with those that it is never taken apart from.

    These are the pictures of its group; and where the same picture is in several groups, those of
    all of them.
    """
    above: dict[str, str] = {}

    def top(name: str) -> str:
        while (upper := above.setdefault(name, name)) != name:
            name = upper
        return name

    pictures = []
    for each in examples:
        pictures.append(each.picture)
        group = f"group {each.group}" if each.group else each.picture
        first, second = sorted((top(each.picture), top(group)))
        above[second] = first
    return {picture: top(picture) for picture in pictures}
