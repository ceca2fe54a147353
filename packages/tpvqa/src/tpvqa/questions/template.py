"""Sentences with placeholders: "Is the {x} {where.place}?"."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from string import Formatter

_ARTICLE = re.compile(r"(?:^|(?<=\s))([Aa])n?(\s+)$")
_ANY_ARTICLE = re.compile(r"(?<![\w'-])(?:the|an?)\s+", re.IGNORECASE)
# How a word sounds where its first letter misleads.
_CONSONANT_SOUND = re.compile(r"(?:uni|use|usu|usb|ute|ufo|eu|ewe|one\b|once)", re.IGNORECASE)
_VOWEL_SOUND = re.compile(r"(?:hour|honest|honou?r|heir)", re.IGNORECASE)
_SPELLED_OUT = re.compile(r"[AEFHILMNORSX][A-Z0-9]+\b")


@dataclass(frozen=True, slots=True)
class Placeholder:
    """`{x}` or `{x.attribute}`; the attribute is "name" where none is written."""

    parameter: str
    attribute: str = "name"

    def __str__(self) -> str:
        suffix = "" if self.attribute == "name" else f".{self.attribute}"
        return f"{{{self.parameter}{suffix}}}"


@dataclass(frozen=True, slots=True)
class Template:
    """A sentence, in parts: words and placeholders.

    "a" or "an" directly before a placeholder agrees with what is put there.
    """

    parts: tuple[str | Placeholder, ...]

    @staticmethod
    def parse(text: str) -> "Template":
        """Read a sentence; white space is evened out, `{{` and `}}` are braces.

        Raises:
            ValueError: A placeholder is malformed.
        """
        parts: list[str | Placeholder] = []
        for words, field, spec, conversion in Formatter().parse(" ".join(text.split())):
            if words:
                parts.append(words)
            if field is None:
                continue
            named = re.fullmatch(r"\??([\w-]+)(?:\.([\w-]+))?", field.strip())
            if named is None or spec or conversion:
                raise ValueError(f"{{{field}}} is no placeholder; write {{x}} or {{x.attribute}}")
            parts.append(Placeholder(named[1].lower(), (named[2] or "name").lower()))
        return Template(tuple(parts))

    def placeholders(self) -> Iterator[Placeholder]:
        """The placeholders, in order."""
        return (part for part in self.parts if isinstance(part, Placeholder))

    def render(self, word: Callable[[Placeholder], str]) -> str:
        """The sentence with its placeholders filled.

        Args:
            word: Gives what stands for a placeholder; asked for the attribute "article" too,
                where "" means the article that the name's sound wants.
        """
        said = words = ""  # an "A" at the end of what was filled in is a name's, and no article
        for part in self.parts:
            if isinstance(part, str):
                said, words = said + part, part
                continue
            filling = word(part)
            before = _ARTICLE.search(words)
            if before and (before.start() or len(words) == len(said)):
                own = word(Placeholder(part.parameter, "article"))
                article = own or indefinite_article(filling)
                article = article.capitalize() if before[1].isupper() else article
                said = said[: len(said) - len(before[0])] + article + before[2]
            said, words = said + filling, ""
        return said

    def without_articles(self) -> "Template":
        """The sentence without its own articles: "wash the {x}" → "wash {x}"."""
        return Template(
            tuple(
                _ANY_ARTICLE.sub("", part) if isinstance(part, str) else part for part in self.parts
            )
        )

    def __str__(self) -> str:
        return "".join(
            part.replace("{", "{{").replace("}", "}}") if isinstance(part, str) else str(part)
            for part in self.parts
        )


def indefinite_article(name: str) -> str:
    """ "a" or "an", by how a name sounds."""
    if _VOWEL_SOUND.match(name) or _SPELLED_OUT.match(name):
        return "an"
    if _CONSONANT_SOUND.match(name) or re.match(r"[A-Z][A-Z0-9]+\b", name):
        return "a"
    return "an" if name[:1].lower() in {"a", "e", "i", "o", "u"} else "a"
